"""Brings what the pairs say about one another to the table and its list, and does the remedies."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from qtpy.QtGui import QAction

from pinwarp.core.findings import FindingKind, gravest_first
from pinwarp.core.landmarks import Role
from pinwarp.core.mirror import axis_to_mirror
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.gui.placing.hand import LandmarkRequests
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.gui.table.panel import LandmarkPanel
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import NamedFinding, Quality, named_findings
from pinwarp.session.naming import in_words
from pinwarp.session.warp.pair_names import pair_names

# These are about the penalty and the solve, and told where the penalty is set.
_TOLD_ELSEWHERE = (FindingKind.NEARLY_PLANAR, FindingKind.POLE)


class FindingsPresenter:
    """Everything between the quality of the pairs and the landmark panel.

    Parameters
    ----------
    editor
        The truth.
    quality, maps
        Where the figures and the folds come from.
    model, panel
        The table and the list below it.
    actions
        The window's actions by key.
    requests
        Moves landmarks, unless they are locked.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        quality: QualityPresenter,
        maps: MapPresenter,
        model: LandmarkModel,
        panel: LandmarkPanel,
        actions: Mapping[str, QAction],
        requests: LandmarkRequests,
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._source = quality
        self._maps = maps
        self._model = model
        self._panel = panel
        self._actions = actions
        self._requests = requests
        self._say = say
        self._found: tuple[NamedFinding, ...] = ()
        self._shown_for: object = None
        panel.findings.chosen.connect(self._choose)
        panel.findings.swap_requested.connect(self._swap)
        panel.findings.mirror_requested.connect(self._mirror)
        panel.findings.disable_requested.connect(self._disable)
        actions["next_finding"].triggered.connect(lambda _checked=False: self.next())
        actions["swap_destinations"].triggered.connect(
            lambda _checked=False: requests.swap_destinations(editor.selection.names)
        )
        quality.quality_changed.connect(self._on_quality)
        maps.folds_changed.connect(self._on_folds)
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_selection)
        self._on_session()

    def shut_down(self) -> None:
        """Let go of the editor and the figures."""
        self._source.quality_changed.disconnect(self._on_quality)
        self._maps.folds_changed.disconnect(self._on_folds)
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.selection_changed.disconnect(self._on_selection)

    # What is shown

    def _on_quality(self, quality: Quality | None) -> None:
        self._model.show_quality(quality)
        self._show()

    def _on_folds(self, _folds: object) -> None:
        self._show()

    def _on_session(self, _changed: object = None) -> None:
        if self._editor.is_previewing:
            # Names do not change in a drag, and its figures come by themselves.
            return
        self._show()
        self._on_selection()

    def _show(self) -> None:
        session, quality, survey = self._editor.session, self._source.quality, self._maps.survey
        key = (session.landmarks, session.unit, session.source, quality, survey)
        if key == self._shown_for:
            return
        self._shown_for = key
        found = quality.findings_in(session) if quality is not None else ()
        if survey is not None:
            found += named_findings(survey.findings, survey.result.inputs, session)
        # Folds come behind what causes them, what is only isolated last.
        found = gravest_first(found)
        self._found = tuple(one for one in found if one.finding.kind not in _TOLD_ELSEWHERE)
        self._model.show_findings(self._found)
        self._panel.findings.show_findings(self._found, self._mirror_axis(quality))
        self._panel.findings.show_selection(self._editor.selection.names)
        self._actions["next_finding"].setEnabled(bool(self._found))

    def _mirror_axis(self, quality: Quality | None) -> str:
        mirrored = any(one.finding.kind is FindingKind.MIRRORED for one in self._found)
        if quality is None or not mirrored:
            return ""
        axis = axis_to_mirror(quality.inputs.source, quality.inputs.destination)
        return axis if self._actions[f"mirror_{axis}"].isEnabled() else ""

    def _on_selection(self, _changed: object = None) -> None:
        session, names = self._editor.session, self._editor.selection.names
        self._panel.findings.show_selection(names)
        chosen = [mark for name in names if (mark := session.landmark(name)) is not None]
        self._actions["swap_destinations"].setEnabled(
            len(chosen) == 2 and all(mark.is_complete and mark.role is Role.PAIR for mark in chosen)
        )

    # What is asked for

    def _choose(self, found: NamedFinding) -> None:
        """Select the landmarks of a finding and look at them."""
        self._panel.reveal(found.names)
        self._editor.select(*found.names)
        self._actions["focus"].trigger()

    def next(self) -> None:
        """Choose the finding after the one that is selected, and let the keys go to it."""
        if not self._found:
            return
        chosen = set(self._editor.selection.names)
        here = [i for i, one in enumerate(self._found) if set(one.names) == chosen]
        following = (here[0] + 1) % len(self._found) if here else 0
        self._choose(self._found[following])
        self._panel.findings.focus_row(following)

    def _is_current(self, found: NamedFinding) -> bool:
        """Whether the pairs are still those that were judged: a second click must not undo it."""
        quality = self._source.quality
        if quality is None:
            return False
        names = pair_names(quality.inputs, self._editor.committed, exactly=True)
        return tuple(names[row] for row in found.finding.rows) == found.names

    def _swap(self, found: NamedFinding) -> None:
        if self._is_current(found):
            self._requests.swap_destinations(found.names)

    def _mirror(self, axis: str) -> None:
        self._actions[f"mirror_{axis}"].trigger()

    def _disable(self, found: NamedFinding, names: Sequence[str]) -> None:
        if self._is_current(found):
            session = edits.set_enabled(self._editor.committed, names, False)
            self._editor.commit(session, f"Disable {in_words(names)}")
            takes = "takes" if len(names) == 1 else "take"
            self._say(f"{in_words(names)} no longer {takes} part: Ctrl+Z undoes it.")
