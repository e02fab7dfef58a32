"""``pinwarp [open]``: the window on some files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Protocol

import typer

from pinwarp.cli.telling import tell
from pinwarp.io.file_names import is_model_file, is_session
from pinwarp.version import __version__


def _tell_version(wanted: bool) -> None:
    if wanted:
        tell(f"pinwarp {__version__}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option("--version", callback=_tell_version, is_eager=True, help="Show the version."),
]


class OpenWindow(Protocol):
    """Opens the window on some files and returns the exit code."""

    def __call__(
        self,
        *,
        session: Path | None,
        model: Path | None,
        source: Path | None,
        destination: Path | None,
        source_landmarks: Path | None,
        destination_landmarks: Path | None,
        passengers: Path | None,
        demo: bool,
        screenshot: Path | None,
    ) -> int:
        """Open it."""


def make_open(open_window: OpenWindow) -> Callable[..., None]:
    """Return the command."""

    def open_(
        files: Annotated[
            list[Path] | None,
            typer.Argument(
                metavar="[SOURCE DESTINATION | SESSION | MODEL]",
                help="Two meshes, a saved session (.pinwarp.csv), or a model (.osim) or its study "
                "(.pinwarp-model.csv).",
                show_default=False,
            ),
        ] = None,
        source_landmarks: Annotated[
            Path | None, typer.Option(metavar="FILE", help="Landmarks on the source mesh.")
        ] = None,
        destination_landmarks: Annotated[
            Path | None, typer.Option(metavar="FILE", help="Landmarks on the destination mesh.")
        ] = None,
        passengers: Annotated[
            Path | None,
            typer.Option(
                metavar="FILE", help="Landmarks on the source mesh to be carried, not solved for."
            ),
        ] = None,
        demo: Annotated[bool, typer.Option("--demo", help="Open the sample bones.")] = False,
        screenshot: Annotated[
            Path | None,
            typer.Option(
                metavar="FILE.png", help="Save a picture of the window and exit, on a server too."
            ),
        ] = None,
        version: Version = False,
    ) -> None:
        """Open the window and watch one bone warp into the other, live ("open" may be left out)."""
        del version  # told before anything else
        session, model, source, destination = _sort_files(files or [])
        if demo and (files or source_landmarks or destination_landmarks or passengers):
            raise typer.BadParameter("--demo opens the sample bones: give no files with it.")
        raise typer.Exit(
            open_window(
                session=session,
                model=model,
                source=source,
                destination=destination,
                source_landmarks=source_landmarks,
                destination_landmarks=destination_landmarks,
                passengers=passengers,
                demo=demo,
                screenshot=screenshot,
            )
        )

    return open_


def _sort_files(
    files: list[Path],
) -> tuple[Path | None, Path | None, Path | None, Path | None]:
    """Tell a session and a model from meshes."""
    for path in files:
        if not path.exists():
            # A word without a dot may be a mistyped command.
            hint = "" if "." in str(path) else " It is no command either: see pinwarp --help."
            raise typer.BadParameter(f"{path} does not exist.{hint}")
    if len(files) == 1 and is_session(files[0]):
        return files[0], None, None, None
    if len(files) == 1 and is_model_file(files[0]):
        return None, files[0], None, None
    if any(is_session(path) or is_model_file(path) for path in files):
        raise typer.BadParameter("Give one session or model, or a source and a destination mesh.")
    if len(files) > 2:
        raise typer.BadParameter("Give at most two meshes: the source and the destination.")
    source, destination = (*files, None, None)[:2]
    return None, None, source, destination
