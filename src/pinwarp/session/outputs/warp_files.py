"""Meshes and landmark files carried through a session's warp."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.mirror import mirrored_points
from pinwarp.core.spline import Spline
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, read_landmarks
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.io.meshes import MESH_SUFFIXES, write_mesh
from pinwarp.io.osim.bone import mesh_suffix, read_any_mesh, split_bone_path
from pinwarp.session.importing.conversion import frame_notes, write_in_frame
from pinwarp.session.outputs.replacing import refuse_to_replace
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import provenance
from pinwarp.session.warp.solved import SolvedWarp, solved

WARPED = "_warped"


def outputs_of(inputs: Sequence[Path], out: Path, *, kept: Iterable[Path] = ()) -> tuple[Path, ...]:
    """Return where each of some inputs goes; nothing is written yet, what is there may be replaced.

    Parameters
    ----------
    inputs
        Meshes and landmark files.
    out
        A file where there is one input and the name ends as a mesh or landmark file does, else
        a folder: there ``femur.ply`` becomes ``femur_warped.ply``.
    kept
        Files that must not be replaced either, such as the session.

    Raises
    ------
    PinwarpError
        When an output is an input, or would be written twice.

    Examples
    --------
    >>> [path.as_posix() for path in outputs_of([Path("a/femur.ply")], Path("warped"))]
    ['warped/femur_warped.ply']
    """
    is_file = out.name.lower().endswith((*MESH_SUFFIXES, *LANDMARK_SUFFIXES)) and not out.is_dir()
    if is_file and len(inputs) > 1:
        raise PinwarpError(f"{out} is one file for {len(inputs)} inputs: give a folder instead.")
    outputs = (out,) if is_file else tuple(out / _warped_name(path) for path in inputs)
    taken: dict[str, Path] = {}
    for source, path in zip(inputs, outputs, strict=True):
        if other := taken.get(str(path).casefold()):
            raise PinwarpError(
                f"{other} and {source} would both become {path}: warp them into two folders."
            )
        taken[str(path).casefold()] = source
    refuse_to_replace([*inputs, *kept], outputs)
    return outputs


def _warped_name(path: Path) -> str:
    # All of a suffix such as .landmarks.csv stays behind.
    stem, dot, suffixes = path.name.partition(".")
    if split_bone_path(path) is not None:
        return f"{path.name}{WARPED}{mesh_suffix(path)}"
    if path.suffix.lower() in MESH_SUFFIXES:
        stem, dot, suffixes = path.stem, ".", path.suffix[1:]
    return f"{stem}{WARPED}{dot}{suffixes}"


class FileWarper:
    """Carries files through the warp of a session.

    Parameters
    ----------
    warp
        The warp of a session with its source mesh read, where the session sees it in a mirror;
        or that session.

    Raises
    ------
    PinwarpError
        When there is no pair, the solve fails, or the mesh that tells where the mirror is is
        missing.
    """

    def __init__(self, warp: Session | SolvedWarp) -> None:
        warp = solved(warp)
        session = warp.session
        self._unit = session.unit
        self._spline: Spline = warp.applied
        self._made = provenance(session)
        self._axes = "" if session.source is None else session.source.mirrored
        self._scale = 1.0 if session.source is None else session.source.scaled
        self._mesh = session.mesh(Side.SOURCE)
        if self._axes and self._mesh is None and session.source is not None:
            raise PinwarpError(
                f"The session sees its source in a mirror, and {session.source.path}, which "
                "tells where the mirror is, is not there. Was it moved or renamed?"
            )

    def warp(self, source: Path, output: Path) -> tuple[str, ...]:
        """Warp one file.

        Parameters
        ----------
        source
            A mesh, or landmarks: of a file of pairs the source side is taken. Positions are in
            the frame of the source mesh's file.
        output
            Its suffix tells the format. Landmarks keep their names.

        Returns
        -------
        tuple of str
            What was changed or left out, as sentences.

        Raises
        ------
        FileFormatError
            When the file cannot be read, or the output's format cannot hold it.
        OSError
            When the output cannot be written.
        """
        output.parent.mkdir(parents=True, exist_ok=True)
        if mesh_suffix(source) in MESH_SUFFIXES:
            file = read_any_mesh(source)
            faces = file.mesh.faces[:, ::-1] if len(self._axes) % 2 else file.mesh.faces
            mesh = Mesh(self._carried(file.mesh.vertices), faces)
            write_mesh(output, mesh, VertexData(remarks=self._made))
            return file.notes
        reading = read_landmarks(source, Side.SOURCE)
        placed = [landmark for landmark in reading.landmarks if landmark.source is not None]
        carried = self._carried(positions(placed, Side.SOURCE))
        landmarks = [
            landmark.placed(Side.DESTINATION, place)
            for landmark, place in zip(placed, carried, strict=True)
        ]
        notes = frame_notes(reading, self._unit)
        # Numbers of a file with a unit stay in it; others are in the session's.
        unit = "" if reading.unit else self._unit
        notes += write_in_frame(
            output,
            landmarks,
            Side.DESTINATION,
            frame=reading.frame,
            unit=unit,
            remarks=self._made,
        )
        skipped = tuple(f"line {x.line} was skipped: {x.reason}." for x in reading.skipped)
        return (*reading.notes, *notes, *skipped)

    def _carried(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Carry places over, seen first as the session sees its source: scaled, in a mirror."""
        places = self._scale * places
        for axis in self._axes:
            assert self._mesh is not None, "checked at the start"
            places = mirrored_points(places, self._mesh, axis)
        return self._spline.evaluate(places)


@dataclass(frozen=True)
class WarpedFile:
    """What became of one file.

    Attributes
    ----------
    source, output
        The file and where it went.
    notes
        What was changed or left out, as sentences.
    error
        Why it failed, as a sentence; empty where it did not.
    """

    source: Path
    output: Path
    notes: tuple[str, ...] = ()
    error: str = ""


def warp_each(
    warper: FileWarper, sources: Sequence[Path], outputs: Sequence[Path]
) -> Iterator[WarpedFile]:
    """Warp files one after the other; the others do not suffer from a bad one.

    Parameters
    ----------
    warper
        Carries them.
    sources, outputs
        What is warped and where it goes, one by one; see :func:`outputs_of`.

    Yields
    ------
    WarpedFile
        As soon as it is done.
    """
    for source, output in zip(sources, outputs, strict=True):
        try:
            yield WarpedFile(source, output, warper.warp(source, output))
        except (PinwarpError, OSError) as error:
            yield WarpedFile(source, output, error=words_of(error))
