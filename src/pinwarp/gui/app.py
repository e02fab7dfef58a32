"""Start the window, or draw it into a picture and leave."""

from __future__ import annotations

import errno
import os
import sys
import threading
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import platformdirs
from qtpy.QtCore import QEvent, QEventLoop, QSettings, QTimer, Signal
from qtpy.QtWidgets import QApplication
from threadpoolctl import threadpool_limits

from pinwarp.core import kernel, surface_distance
from pinwarp.core.errors import words_of
from pinwarp.core.landmarks import Side
from pinwarp.core.words import some_of
from pinwarp.gui.files.documents import Opening
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.gui.window.text_size import remembered_size, write_in
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.atomic import sweep
from pinwarp.io.samples import sample_session
from pinwarp.session.importing.landmarks import Arriving, ImportChoice
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session

# Drawing a million triangles in software takes a while; a minute means that something hangs.
_LONGEST_WAIT_MS = 60_000
_WARM_UP_AFTER_MS = 1_500


class PrintedMessages(WindowDialogs):
    """Says on the terminal what would wait for a click: for pictures without a user."""

    def __init__(self) -> None:
        self.errors: list[str] = []

    def ask_missing_mesh(self, side: str, path: Path, other: Path | None) -> Path | None:
        """Go on without the mesh, and say so."""
        there = f" {other} has its name but not its content." if other is not None else ""
        self.tell_error("Mesh not found", f"The {side} mesh {path} is not there.{there}")
        return None

    def ask_choice(self, title: str, text: str, more: str, labels: Sequence[str]) -> int:
        """Leave things as they are, which is the last choice, and say so."""
        self.tell(title, f"{text}\n{more}")
        return len(labels) - 1

    def ask_import(
        self, session: Session, arriving: Arriving, _rulers: Rulers
    ) -> ImportChoice | None:
        """Leave out what nobody can be asked about, and say so."""
        others = [x.name for x in arriving.landmarks if session.landmark(x.name) is None]
        way_out = (
            "Give it as --passengers if the warp is to carry them."
            if arriving.side is Side.SOURCE
            else "In the window you can say what they are."
        )
        self.tell_error(
            "Names that are not here",
            f"{arriving.path.name} was left out: all landmarks are paired, and it brings others "
            f"({some_of(others)}). {way_out}",
        )
        return None

    def tell_error(self, title: str, text: str) -> None:
        """Print an error."""
        self.errors.append(text)
        print(f"{title}: {text}", file=sys.stderr)

    def tell(self, title: str, text: str, details: str = "") -> None:
        """Print a message."""
        print("\n".join(filter(None, (f"{title}: {text}", details))), file=sys.stderr)


class Application(QApplication):
    """The application; ``file_came`` with the path of a file that the desktop hands to it.

    macOS starts no second program for a file that is double-clicked, and names none to the first.
    """

    file_came = Signal(object)

    def event(self, event: QEvent) -> bool:
        """Take a file."""
        if event.type() == QEvent.Type.FileOpen and event.file():
            self.file_came.emit(Path(event.file()))
            return True
        return super().event(event)


def make_application() -> Application:
    """Return the one application, set up for pinwarp."""
    existing = QApplication.instance()
    if isinstance(existing, Application):
        return existing
    application = Application(["pinwarp"])
    application.setApplicationName("pinwarp")
    # By this a desktop knows which of its entries the window belongs to.
    application.setDesktopFileName("pinwarp")
    application.setStyle("fusion")
    return application


def user_settings() -> QSettings:
    """Return the settings in the user's configuration folder.

    Raises
    ------
    OSError
        When nothing can be remembered there.
    """
    folder = platformdirs.user_config_path("pinwarp")
    folder.mkdir(parents=True, exist_ok=True)
    settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    if not settings.isWritable() or settings.status() is QSettings.Status.AccessError:
        raise OSError(errno.EACCES, os.strerror(errno.EACCES), settings.fileName())
    return settings


def no_settings() -> QSettings:
    """Return settings that remember nothing: a picture shows the window as it comes."""
    # Below a file there is no folder. Not the null device: for root, Qt puts a file in its place.
    return QSettings(str(Path(__file__) / "none.ini"), QSettings.Format.IniFormat)


def run(opening: Opening, *, demo: bool = False, screenshot: Path | None = None) -> int:
    """Open the window on some files.

    Parameters
    ----------
    opening
        The files.
    demo
        Open the sample bones.
    screenshot
        Draw the window into this PNG and leave.

    Returns
    -------
    int
        The exit code.
    """
    application = make_application()
    # The spline's own threads and BLAS's would fight over the cores.
    with threadpool_limits(limits=1, user_api="blas"):
        if screenshot is None:
            return _run_for_user(application, opening, demo=demo)
        dialogs = PrintedMessages()
        window = MainWindow(no_settings(), dialogs)
        window.show()
        begin(window, opening, demo=demo)
        saved = save_picture(window, screenshot)
        failed = not saved or bool(dialogs.errors)
        window.editor.replace_all(window.editor.session, None)
        window.close()
        return 1 if failed else 0


def _run_for_user(application: Application, opening: Opening, *, demo: bool) -> int:
    window = user_window()
    with window.faults.taken_over():
        take_files(application, window)
        window.show()
        # From the event loop: what goes wrong there must not keep the window from starting.
        QTimer.singleShot(0, window, lambda: begin(window, opening, demo=demo))
        # Loading numba takes a second of the interpreter's time: after the first picture.
        folders = {path.parent for path in window.parts.documents.recent}
        in_background = threading.Thread(target=_tidy_and_warm_up, args=(folders,), daemon=True)
        QTimer.singleShot(_WARM_UP_AFTER_MS, in_background.start)
        return int(application.exec())


def user_window(dialogs: WindowDialogs | None = None) -> MainWindow:
    """Return the window with all that the user's folders remember, or without where they cannot.

    Parameters
    ----------
    dialogs
        Asks and tells; the real ones when None.
    """
    try:
        settings, problem = user_settings(), ""
    except (OSError, RuntimeError) as error:  # RuntimeError: nobody knows the home folder
        settings, problem = no_settings(), words_of(error)
    try:
        state_folder: Path | None = platformdirs.user_state_path("pinwarp")
    except RuntimeError:
        state_folder = None
    write_in(remembered_size(settings))
    window = MainWindow(settings, dialogs, state_folder)
    if problem:
        window.note("Settings are not remembered", problem)
    return window


def take_files(application: Application, window: MainWindow) -> None:
    """Open in a window, as long as it lives, what the desktop hands to the application."""
    documents = window.parts.documents
    taken = application.file_came.connect(lambda path: documents.open_files(Side.SOURCE, [path]))
    window.destroyed.connect(lambda: application.file_came.disconnect(taken))


def _tidy_and_warm_up(folders: Iterable[Path]) -> None:
    """Remove what was left, and load all that is compiled, what is needed first before the rest.

    Parameters
    ----------
    folders
        Where a window that was killed may have left half a session.
    """
    for folder in folders:
        sweep(folder)
    kernel.warm_up()
    surface_distance.warm_up()


def begin(window: MainWindow, opening: Opening, *, demo: bool = False) -> None:
    """Offer what was lost before; without it, open what the command line names."""
    if window.parts.recovery.offer(instead_of=opening.paths):
        return
    if demo:
        window.parts.documents.open_session(sample_session(), as_new=True)
    else:
        window.parts.documents.open(opening)


def save_picture(window: MainWindow, path: Path) -> bool:
    """Wait until everything is drawn and save a picture of the window."""
    if not wait_until(lambda: window.is_settled):
        print("pinwarp: gave up waiting for the picture", file=sys.stderr)
        return False
    # One more turn for the last repaint.
    wait(150)
    path.parent.mkdir(parents=True, exist_ok=True)
    if not window.grab().save(str(path)):
        print(f"pinwarp: cannot write {path}", file=sys.stderr)
        return False
    return True


def wait(milliseconds: int) -> None:
    """Let the window live for a while."""
    loop = QEventLoop()
    QTimer.singleShot(milliseconds, loop.quit)
    loop.exec()


def wait_until(condition: Callable[[], bool]) -> bool:
    """Let the window live until something holds; False where that takes too long."""
    waited = 0
    while not condition():
        wait(20)
        waited += 20
        if waited > _LONGEST_WAIT_MS:
            return False
    return True
