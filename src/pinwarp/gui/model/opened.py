"""The model that is open, and the work on its bodies: one in the editor, the others set aside."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.words import counted, some_of
from pinwarp.gui.files.file_dialogs import Answer, FileDialogs, Overwrite
from pinwarp.gui.files.recovery import Recovery
from pinwarp.gui.files.saving import Saving
from pinwarp.gui.files.session_meshes import SessionMeshes
from pinwarp.gui.tasks.file_tasks import STUDY_FILES, FileTasks, Progress
from pinwarp.io.file_names import STUDY_SUFFIX, session_of_body
from pinwarp.io.meshes import MeshFile
from pinwarp.io.osim.bone import bone_of, bone_path, split_bone_path
from pinwarp.io.reading import hash_of
from pinwarp.io.session_file import SessionRecord, read_session
from pinwarp.session.editor import Editor, Work
from pinwarp.session.keeping.journal import Aside
from pinwarp.session.model.bench import Bench, BodyWork, open_bench
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated

_NOT_THERE = "Put it there, or choose the folder that it is in."


class OpenedModel:
    """Opens a model, and changes between its bodies without losing anything.

    ``changed`` tells that there is another model, body or session.

    Parameters
    ----------
    editor
        Has the session of the body that is worked on.
    tasks
        Runs, asks and tells.
    saving
        Writes sessions, and asks before one that is of no body would be lost.
    recovery
        Keeps what is set aside in case the program dies.
    meshes
        Reads the meshes of sessions.

    Attributes
    ----------
    bench : Bench or None
        The model.
    chosen : str
        The body that the editor's session is of; empty where it is of none.
    """

    changed = isolated()

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[FileDialogs],
        saving: Saving,
        recovery: Recovery,
        meshes: SessionMeshes,
    ) -> None:
        self._editor, self._tasks, self._saving = editor, tasks, saving
        self._recovery, self._meshes = recovery, meshes
        self.bench: Bench | None = None
        self.chosen = ""
        self._wanted = ""
        self._asides: dict[str, Aside | None] = {}
        saving.name_untitled(self._proposal)
        self._signals = (editor.session_changed, editor.saved)
        for signal in self._signals:
            signal.connect(self._follow)

    def shut_down(self) -> None:
        """Let go of the editor."""
        for signal in self._signals:
            signal.disconnect(self._follow)

    @property
    def body(self) -> BodyWork | None:
        """The body that is worked on."""
        return None if self.bench is None else self.bench.bodies.get(self.chosen)

    # Opening and putting away

    def open(self, path: Path) -> None:
        """Open a model or the study of one; the session that is open stays."""

        def arrived(bench: Bench) -> None:
            if not self.may_put_away():
                self._tasks.said.emit("Nothing was opened: this model stays")
                return
            self._put_away()
            self.bench = bench
            self._follow()
            self.changed.emit()
            bodies = counted(len(bench.bodies), "body", "bodies")
            self._tasks.said.emit(f"Opened {path.name}: {bodies}. Choose one in the Model tab")
            if bench.notes:
                self._tasks.dialogs.tell("The model has changed", "\n".join(bench.notes))

        place = path.absolute()
        self._tasks.run(
            f"Opening {path.name}", lambda progress: open_bench(place, told=progress), arrived
        )

    def close(self) -> None:
        """Put the model away, asking about unsaved work; the session that is open stays."""
        if self.may_put_away():
            self._put_away()
            self.changed.emit()

    def may_put_away(self) -> bool:
        """Ask about unsaved work on bodies that were set aside, and on the study."""
        bench = self.bench
        if bench is None:
            return True
        names = [one.name for one in bench.unsaved if one is not self.body]
        if not names and not bench.is_dirty:
            return True
        of = f" ({some_of(names)})" if names else ""
        answer = self._tasks.dialogs.ask_unsaved(f"the study of {bench.name}{of}")
        return self.save() if answer is Answer.SAVE else answer is Answer.DISCARD

    def _put_away(self) -> None:
        for aside in self._asides.values():
            self._recovery.forget(aside)
        self._asides.clear()
        self.bench, self.chosen, self._wanted = None, "", ""

    # Changing between bodies

    def choose(self, body: str) -> None:
        """Work on a body: its bone becomes the source, or what was set aside is taken up again."""
        bench = self.bench
        if bench is None:
            return
        self._wanted = body
        if body == self.chosen:
            return
        one = bench.bodies[body]
        if one.work is not None:
            if self._leave():
                self._take_up(body, one.work)
            self.changed.emit()
        elif one.path is not None:
            self._open_session(bench, body, one.path)
        else:
            self._open_bone(bench, body)

    def _open_bone(self, bench: Bench, body: str) -> None:
        one = bench.bodies[body]
        if one.overview.missing and not self._locate(bench, one):
            self.changed.emit()
            return

        def read(progress: Progress) -> MeshFile:
            return self._meshes.ready(bone_of(bench.model, body, bench.folders).file, progress)

        def arrived(file: MeshFile) -> None:
            self._arrive(bench, body, Session(source=file, unit="m"), None, None)

        self._tasks.run(f"Reading {one.name}", read, arrived)
        # Until then the other body stays chosen.
        self.changed.emit()

    def _locate(self, bench: Bench, one: BodyWork) -> bool:
        """Ask for the folder of meshes that are missing; say whether to go on."""
        answer = self._tasks.dialogs.ask_choice(
            f"Meshes of {one.name} not found",
            f"{some_of(one.overview.missing)}: not beside the model nor in its Geometry folder.",
            _NOT_THERE,
            ["Choose the Folder…", "Cancel"],
        )
        if answer != 0:
            return False
        folder = self._tasks.dialogs.ask_folder("Where the meshes are", bench.model.path.parent)
        if folder is None:
            return False
        bench.folders = (*bench.folders, folder)
        one.overview = replace(one.overview, missing=())
        return True

    def _open_session(self, bench: Bench, body: str, path: Path) -> None:
        sha256 = hash_of(path)
        try:
            record = read_session(path)
        except (PinwarpError, OSError) as error:
            self._tasks.dialogs.tell_error("Cannot open the session", words_of(error))
            self.changed.emit()
            return

        def arrived(session: Session) -> bool:
            return self._arrive(bench, body, session, path, sha256)

        title = f"Opening {path.name}"
        self._meshes.open(_moved(record, bench, body), path.parent, title, arrived)
        self.changed.emit()

    def _arrive(
        self, bench: Bench, body: str, session: Session, path: Path | None, sha256: str | None
    ) -> bool:
        """Show the session of a body, unless something else is wanted by now."""
        if self.bench is not bench or self._wanted != body:
            return False
        if not self._leave():
            self.changed.emit()
            return False
        rules = bench.bodies[body].rules
        self._editor.replace_all(session, path, sha256=sha256, rules=rules)
        self._adopt(body)
        self.changed.emit()
        return True

    def _leave(self) -> bool:
        """Set aside what is in the editor, or ask about it where it is of no body."""
        body = self.body
        if body is None:
            return self._saving.may_lose_changes()
        body.work = self._editor.work
        self._asides[self.chosen] = self._recovery.set_aside()
        self.chosen = ""
        return True

    def _take_up(self, body: str, work: Work) -> None:
        self._editor.take_up(work)
        self._recovery.take_up(self._asides.pop(body, None))
        self._adopt(body)

    def _adopt(self, body: str) -> None:
        if self.bench is not None:
            self.chosen = self._wanted = body
            self.bench.bodies[body].work = self._editor.work

    def _follow(self, _changed: object = None) -> None:
        """Notice which body the editor's session is of, and where it is saved."""
        bench, editor = self.bench, self._editor
        if bench is None or editor.is_previewing:
            return
        one = self.body
        if one is not None and one.work is not None:
            if one.work.history is editor.work.history:
                one.work = editor.work
                return
            # Another session has taken its place; it was asked about.
            one.renounce()
            self.chosen = ""
        body = bench.body_of(editor.committed)
        known = bench.bodies[body].work if body else None
        if body and (known is None or known.history is editor.work.history):
            self._adopt(body)
        self.changed.emit()

    # Saving

    def save(self) -> bool:
        """Save the sessions of all bodies and the study; say whether all was saved."""
        bench = self.bench
        if bench is None:
            return True
        path = bench.path or self._ask_path(bench)
        if path is None:
            return False
        for body, one in bench.bodies.items():
            if one.work is None or not one.is_worth_saving:
                continue
            is_named = one.current_path is not None
            if (one.is_unsaved or not is_named) and not self._save_body(path, body, one):
                return False
        if not self._tasks.write(lambda: bench.save(path), path):
            return False
        self._tasks.said.emit(f"Saved {path.name}")
        self.changed.emit()
        return True

    def _ask_path(self, bench: Bench) -> Path | None:
        proposal = bench.model.path.with_name(f"{bench.model.path.stem}{STUDY_SUFFIX}")
        asked = self._tasks.dialogs.ask_save("Save the study", STUDY_FILES, proposal)
        if asked is None or asked.name.lower().endswith(STUDY_SUFFIX):
            return asked
        path = asked.with_name(asked.name.removesuffix(".csv") + STUDY_SUFFIX)
        if not path.exists():
            return path
        # The file dialog has asked about another name.
        return self._ask_over(path, "is there already")

    def _ask_over(self, path: Path, reason: str) -> Path | None:
        answer = self._tasks.dialogs.ask_overwrite(path.name, reason)
        if answer is Overwrite.SAVE_AS:
            return self._tasks.dialogs.ask_save("Save the session", STUDY_FILES, path)
        return path if answer is Overwrite.OVERWRITE else None

    def _save_body(self, study: Path, body: str, one: BodyWork) -> bool:
        work = one.work
        assert work is not None, "only what was worked on is saved"
        path: Path | None = work.path
        if path is None:
            stem = study.name.removesuffix(STUDY_SUFFIX)
            path = session_of_body(study, stem, one.name)
            if path.exists():
                path = self._ask_over(path, "is there already")
        elif work.file_sha256 is not None and hash_of(path) not in (work.file_sha256, None):
            path = self._ask_over(path, "was changed by another program or window")
        if path is None or not self._saving.write(work.history.session, path):
            return False
        if body == self.chosen:
            self._editor.mark_saved(path, hash_of(path))
            return True
        work.history.mark_saved()
        one.work = Work(work.history, path, hash_of(path))
        self._recovery.forget(self._asides.pop(body, None))
        return True

    def _proposal(self) -> Path | None:
        """Return how the session of a body is called while it has no name."""
        if self.bench is None or self.body is None:
            return None
        beside = self.bench.path or self.bench.model.path
        return session_of_body(beside, self.bench.name, self.body.name)


def _moved(record: SessionRecord, bench: Bench, body: str) -> SessionRecord:
    """Return a session with its bone in the model that is open, wherever that was before."""
    source = record.source_mesh
    named = None if source is None else split_bone_path(source.path)
    if source is None or named is None or named[1] != body:
        return record
    return replace(record, source_mesh=replace(source, path=bone_path(bench.model.path, body)))
