"""Rows of a manifest that mean every specimen of a file: a subject for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.core.names import visible
from pinwarp.io.file_names import as_file_name
from pinwarp.io.landmark_files import ALL, located, read_landmarks
from pinwarp.io.manifest import Manifest, Subject


def with_specimens(manifest: Manifest) -> Manifest:
    """Return a manifest with a row for each specimen where one means ``FILE#all``.

    Parameters
    ----------
    manifest
        A row of all gives its name to each, with the specimen's behind it. Where the file cannot
        be read, the row is a subject that fails.

    Raises
    ------
    FileFormatError
        When two subjects get one name.
    """
    subjects: dict[str, Subject] = {}
    for row in manifest.subjects:
        for subject in _expanded(row):
            look = visible(subject.name).casefold()
            if look in subjects:
                raise FileFormatError(
                    manifest.path,
                    f"Two subjects would be called {subject.name!r}: the files of one would "
                    "replace the other's. Rename one.",
                    subject.line,
                )
            subjects[look] = subject
    return replace(manifest, subjects=tuple(subjects.values()))


def _expanded(row: Subject) -> Iterator[Subject]:
    if row.destination_landmarks is None:
        yield row
        return
    file, which = located(row.destination_landmarks)
    if which != ALL or row.problem:
        yield row
        return
    try:
        specimens = read_landmarks(file, Side.DESTINATION).specimens
    except FileFormatError as error:
        yield replace(row, problem=str(error))
        return
    if not specimens:
        yield replace(row, problem=f"{file.name} holds no specimens: leave out '#{ALL}'.")
    elif row.destination_mesh is not None:
        words = f"One mesh cannot be that of all specimens: write a row for each, {file.name}#NAME."
        yield replace(row, problem=words)
    else:
        for name in specimens:
            yield replace(
                row,
                name=f"{row.name}_{as_file_name(name)}",
                destination_landmarks=file.with_name(f"{file.name}#{name}"),
            )
