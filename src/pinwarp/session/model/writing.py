"""Writing a warped model: meshes first, then the model, read again before it takes its place."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import numpy as np

from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.model_warp import WarpedBody
from pinwarp.io.atomic import write_atomically
from pinwarp.io.file_names import MODEL_SUFFIX
from pinwarp.io.meshes import write_mesh
from pinwarp.io.model_report import write_report_csv
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.geometry import find_mesh_file
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.reading import model_of
from pinwarp.session.model.warped import WarpedModel
from pinwarp.session.outputs.replacing import refuse_to_replace

# Metres that a place may be off when it is read again: nothing but rounding.
_ROUNDING = 1e-9


def outputs_of(warped: WarpedModel, path: str | Path) -> tuple[Path, ...]:
    """Return all files that a warped model is written to: model, report, meshes.

    Parameters
    ----------
    warped
        The model.
    path
        The new model's file.

    Raises
    ------
    PinwarpError
        When it is no ``.osim`` file, or something that was read would be replaced.
    """
    place = Path(os.path.abspath(path))
    if place.suffix.lower() != MODEL_SUFFIX:
        raise PinwarpError(f"{place.name} is no name of a model: it ends in {MODEL_SUFFIX}.")
    meshes = [place.parent / name for name in warped.mesh_names(_folder(place)).values()]
    outputs = (place, place.with_name(f"{place.stem}_report.csv"), *meshes)
    study = warped.study
    sessions = [each.path for each in study.bodies if each.path is not None]
    elements = [study.model.elements[key] for key in warped.meshes]
    drawn = [find_mesh_file(study.model, element, study.folders) for element in elements]
    read = [study.model.path, *sessions, *(file for file in drawn if file is not None)]
    refuse_to_replace(read, outputs)
    return outputs


def write_model(warped: WarpedModel, path: str | Path, *, force: bool = False) -> tuple[Path, ...]:
    """Write a warped model ``NEW.osim``, its meshes into ``NEW_Geometry``, and ``NEW_report.csv``.

    Parameters
    ----------
    warped
        The model.
    path
        The new model's file.
    force
        Replace what is there already.

    Returns
    -------
    tuple of Path
        The files that were written.

    Raises
    ------
    PinwarpError
        When something is there already, or what was read would be replaced; nothing is written.
    OSError
        When a file cannot be written; what was begun is removed again.

    Examples
    --------
    >>> import tempfile, pinwarp
    >>> from pinwarp.io.samples import sample_model
    >>> model = pinwarp.read_model(sample_model())
    >>> bone = pinwarp.read_mesh(sample_model().parent / "Geometry" / "shank.obj").mesh
    >>> landmarks = tuple(
    ...     pinwarp.Landmark(f"p{i}", tuple(place * [1, 1.1, 1]), tuple(1.2 * place))
    ...     for i, place in enumerate(bone.vertices[::9])
    ... )
    >>> warped = pinwarp.warp_model(model, {"shank": pinwarp.Session(landmarks=landmarks)})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     files = write_model(warped, Path(folder, "anna.osim"))
    ...     print(*(file.relative_to(folder).as_posix() for file in files))
    anna.osim anna_report.csv anna_Geometry/shank_shank.vtp
    """
    outputs = outputs_of(warped, path)
    place, report, *_ = outputs
    there = [output for output in outputs if output.exists()]
    if there and not force:
        raise PinwarpError(f"{there[0]} is there already: choose another name or replace it.")
    folder = _folder(place)
    data = warped.data(folder)
    _check(model_of(place, data), warped.bodies)
    made: list[Path] = []
    try:
        for key, name in warped.mesh_names(folder).items():
            target = place.parent / name
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists():
                made.append(target)
            write_mesh(target, warped.meshes[key])
        if not report.exists():
            made.append(report)
        write_report_csv(report, warped.rows)
        # The model comes last: where it is, everything that it names is there.
        write_atomically(place, data)
    except BaseException:
        for file in made:
            with contextlib.suppress(OSError):
                file.unlink()
        with contextlib.suppress(OSError):
            (place.parent / folder).rmdir()
        raise
    return outputs


def _folder(place: Path) -> str:
    return f"{place.stem}_Geometry"


def _check(model: OsimModel, bodies: tuple[WarpedBody, ...]) -> None:
    """Read the new model's frames and points and compare them with what was carried.

    Raises
    ------
    FileFormatError
        When one is elsewhere: a fault of ours, better told than written.
    """
    for body in bodies:
        parts = body_parts(model, body.parts.path)
        frames = CarriedFrames(parts, lambda places: places, BodyRules())
        apart = {
            path: np.abs(frames.before(path).origin - after.origin).max()
            for path, after in body.frames.items()
        }
        new = {point.path: frames.place(point) for point in parts.points}
        apart |= {path: np.abs(new[path] - place).max() for path, place in body.places.items()}
        for path, far in apart.items():
            if not far <= _ROUNDING:
                raise FileFormatError(
                    model.path,
                    f"{path} would be {1e3 * far:.3g} mm from where the warp takes it. Nothing "
                    "was written; please report this model.",
                )
