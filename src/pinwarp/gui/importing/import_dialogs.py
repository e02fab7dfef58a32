"""The questions that an import asks."""

from __future__ import annotations

from pinwarp.gui.importing.dialog import ImportDialog
from pinwarp.gui.importing.specimen_dialog import SpecimenDialog
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.session.importing.landmarks import Arriving, ImportChoice
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session


class ImportDialogs(Dialogs):
    """The dialogs of importing."""

    def ask_import(
        self, session: Session, arriving: Arriving, rulers: Rulers
    ) -> ImportChoice | None:
        """Show what a landmark file holds, and ask how to bring it in; None leaves it."""
        dialog = ImportDialog(session, arriving, rulers, self.window)
        accepted = dialog.exec()
        dialog.deleteLater()
        return dialog.choice if accepted else None

    def ask_specimen(self, arriving: Arriving) -> str | None:
        """Ask which specimen of a file is meant; None leaves it."""
        dialog = SpecimenDialog(arriving, self.window)
        accepted = dialog.exec()
        dialog.deleteLater()
        return dialog.chosen if accepted else None
