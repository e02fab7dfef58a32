"""Landmark files into the session, with a look at what they hold before anything changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.importing.import_dialogs import ImportDialogs
from pinwarp.gui.tasks.file_tasks import LANDMARK_FILES, FileTasks, Progress
from pinwarp.io.landmark_files import LandmarkReading, read_landmarks
from pinwarp.session.editor import Editor
from pinwarp.session.importing.asking import brings_strangers, is_plain
from pinwarp.session.importing.fit import Fit, distance_from_mesh, fits_of, fitted
from pinwarp.session.importing.landmarks import (
    Arriving,
    Fate,
    ImportChoice,
    Pairing,
    arrivals,
    default_pairing,
    group_words,
    imported,
)
from pinwarp.session.session import Session


class LandmarkImports(Capability):
    """Reads landmark files, asks where there is something to ask, and brings them in.

    Parameters
    ----------
    editor
        What is read and changed.
    tasks
        Runs, asks and tells.
    """

    def __init__(self, editor: Editor, tasks: FileTasks[ImportDialogs]) -> None:
        self._editor = editor
        self._tasks = tasks
        # While one file is asked about, the next ones wait: they may match what it brings.
        self._waiting: list[tuple[Arriving, bool]] = []
        self._is_deciding = False
        self.actions = (
            Action(
                "import_source",
                "Source Landmarks…",
                lambda: self.ask(Side.SOURCE),
                at="import.11",
                keys="Ctrl+Shift+1",
                deed="Import Source Landmarks",
                tip="Import source landmarks from a file",
            ),
            Action(
                "import_destination",
                "Destination Landmarks…",
                lambda: self.ask(Side.DESTINATION),
                at="import.12",
                keys="Ctrl+Shift+2",
                deed="Import Destination Landmarks",
                tip="Import destination landmarks from a file",
            ),
            Action(
                "import_pairs",
                "Landmark Pairs…",
                lambda: self.ask(None),
                at="import.13",
                tip="Import landmarks from a file with both sides",
            ),
        )

    def ask(self, side: Side | None) -> None:
        """Ask for a landmark file and import it; without a side it must hold pairs."""
        what = f"{side.value} landmarks" if side is not None else "landmark pairs"
        path = self._tasks.dialogs.ask_open(f"Import {what}", LANDMARK_FILES, self._tasks.folder())
        if path is not None:
            self.bring_in(path, side)

    def bring_in(
        self,
        path: Path,
        side: Side | None,
        *,
        asking: bool = True,
        pairing: Pairing | None = None,
    ) -> None:
        """Import landmarks for one side, or pairs where the file holds pairs.

        Parameters
        ----------
        path, side
            The file, and the side it belongs to.
        asking
            Whether to ask before, where there is something to ask; else it is told after. Names
            that nobody here knows are asked about all the same, where everything is paired.
        pairing
            How its landmarks find those of the session, where that is known.
        """

        def arrived(reading: LandmarkReading) -> None:
            if side is None and not reading.is_pairs:
                self._tasks.dialogs.tell_error(
                    "These are not pairs",
                    f"{path.name} holds positions for one mesh only: import it as source or "
                    "destination landmarks.",
                )
                return
            own_side = None if reading.is_pairs and pairing is None else side
            self._compare(Arriving(path, reading, own_side, pairing=pairing), asking)

        self._read(path, side, arrived)

    def _read(
        self, path: Path, side: Side | None, arrived: Callable[[LandmarkReading], None]
    ) -> None:
        title = f"Reading {path.name}"
        self._tasks.run(title, lambda _progress: read_landmarks(path, side or Side.SOURCE), arrived)

    def _compare(self, arriving: Arriving, asking: bool) -> None:
        """Compare positions with the meshes, which were read by now."""
        session, reading = self._editor.committed, arriving.reading
        meshes = {side: session.mesh(side) for side in arriving.sides}

        def compare(progress: Progress) -> Mapping[Side, tuple[Fit, ...]]:
            progress(0.5, "comparing with the mesh")
            return {
                # Points of curves tell as much as landmarks do.
                side: fits_of(reading.landmarks, side, SurfaceIndex(mesh))
                for side, mesh in meshes.items()
                if mesh is not None
            }

        def arrived(fits: Mapping[Side, tuple[Fit, ...]]) -> None:
            if not all(self._is_still(side, mesh) for side, mesh in meshes.items()):
                self._compare(arriving, asking)
                return
            found = replace(arriving, fits=fits)
            self._waiting.append((found, asking))
            self._decide_all()

        self._tasks.run(f"Reading {arriving.path.name}", compare, arrived)

    def _decide_all(self) -> None:
        if self._is_deciding:
            return
        self._is_deciding = True
        try:
            while self._waiting:
                self._decide(*self._waiting.pop(0))
        finally:
            self._is_deciding = False

    def _decide(self, arriving: Arriving, asking: bool) -> None:
        if asking and arriving.must_choose:
            self._choose(arriving)
            return
        session = self._editor.committed
        plain = is_plain(session, arriving)
        pairing = arriving.pairing or default_pairing(session, arriving)
        choice: ImportChoice | None = ImportChoice(pairing)
        asked = asking or (arriving.pairing is None and brings_strangers(session, arriving))
        if asked and not plain:
            choice = self._tasks.dialogs.ask_import(session, arriving, self._editor.rulers)
        if choice is None:
            self._tasks.said.emit("Cancelled; nothing was changed")
            return
        # Meshes may have arrived while the question was open.
        before = self._editor.committed
        self._editor.commit(imported(before, arriving, choice), arriving.label)
        words = (_report(before, arriving, choice), *group_words(before, arriving, choice))
        self._tasks.said.emit(" ".join(words))
        if not asked:
            self._tell_after(arriving)

    def _choose(self, arriving: Arriving) -> None:
        """Ask which specimen is meant, and read that one."""
        name = self._tasks.dialogs.ask_specimen(arriving)
        if name is None:
            self._tasks.said.emit("Cancelled; nothing was changed")
            return

        def arrived(reading: LandmarkReading) -> None:
            self._compare(replace(arriving, reading=reading, is_chosen=True), True)

        path = arriving.path
        self._read(path.with_name(f"{path.name}#{name}"), arriving.side, arrived)

    def _tell_after(self, arriving: Arriving) -> None:
        """Tell what nobody was asked about before."""
        reading = arriving.reading
        if reading.skipped:
            number = len(reading.skipped)
            self._tasks.dialogs.tell(
                "Some lines were skipped",
                f"{_count(arriving)} read from {arriving.path.name}; "
                f"{number:,} line{' was' if number == 1 else 's were'} skipped.",
                "\n".join(
                    f"Line {line.line}: {line.reason}\n    {line.text}" for line in reading.skipped
                ),
            )
        for side in arriving.doubtful:
            self._offer(side, arriving.fits[side], reading.frame)

    # Landmarks that were there before their mesh

    def check(self, side: Side) -> None:
        """Look whether the landmarks of a side lie on the mesh that was opened, and offer help."""
        session = self._editor.committed
        mesh = session.mesh(side)
        if mesh is None or all(x.position(side) is None for x in session.landmarks):
            return
        landmarks = session.landmarks

        def compare(progress: Progress) -> tuple[Fit, ...]:
            progress(0.5, "comparing with the landmarks")
            return fits_of(landmarks, side, SurfaceIndex(mesh))

        def arrived(fits: tuple[Fit, ...]) -> None:
            if len(fits) > 1 and self._is_still(side, mesh):
                self._offer(side, fits)

        self._tasks.run(f"Comparing the {side.value} landmarks", compare, arrived)

    def _is_still(self, side: Side, mesh: Mesh | None) -> bool:
        return self._editor.committed.mesh(side) is mesh

    def _offer(self, side: Side, fits: tuple[Fit, ...], frame: str = "") -> None:
        """Offer to read the landmarks of a side in another way."""
        session = self._editor.committed
        mesh, ruler = session.mesh(side), self._editor.rulers.on(side)
        size = mesh.diagonal if mesh is not None else 0.0
        figures = [
            (fit.describe(frame), distance_from_mesh(fit.distance, size, ruler)) for fit in fits
        ]
        answer = self._tasks.dialogs.ask_choice(
            "Landmarks far from their mesh",
            f"The {side.value} landmarks lie {figures[0][1]} in the median: they may be in another "
            "frame or unit.",
            "\n".join(f"{words}: {length}." for words, length in figures),
            [*(fit.action for fit in fits[1:]), "Leave As They Are"],
        )
        if answer < len(fits) - 1:
            session = fitted(self._editor.committed, side, fits[answer + 1])
            self._editor.commit(session, f"Correct {side.value} landmarks")


def _report(session: Session, arriving: Arriving, choice: ImportChoice) -> str:
    """Say in one line what was brought in, and how."""
    reading = arriving.reading
    how = "" if choice.pairing is Pairing.BY_NAME else f", {choice.pairing.value}"
    left = [x for x in arrivals(session, arriving, choice) if x.fate is Fate.LEFT_OUT]
    if left:
        how += f", {len(left):,} left out"
    parts = [f"{_count(arriving)} from {arriving.path.name} ({reading.format}){how}"]
    parts += [
        f"{side.value.capitalize()}: {fit.describe(reading.frame)}"
        for side, fit in choice.fits.items()
        if not fit.is_as_stored
    ]
    return ". ".join((*parts, *reading.doubts, *reading.notes))


def _count(arriving: Arriving) -> str:
    words = counted(len(arriving.landmarks), "pair" if arriving.reading.is_pairs else "landmark")
    groups = arriving.reading.groups
    if not groups:
        return words
    also = counted(len(groups), "curve or patch", "curves and patches")
    return f"{words} and {also}" if arriving.landmarks else also
