"""Draw the pictures of the user guide, and of the README, from the program itself.

    make pictures

Run on a screen, or under Xvfb: each is a part of the window as a user sees it, on the sample bones.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from qtpy.QtCore import QPoint, QRect, Qt, QTimer
from qtpy.QtGui import QPixmap
from qtpy.QtWidgets import QApplication, QWidget

from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.gui.app import Opening, begin, make_application, no_settings, wait, wait_until
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.mesh_formats.vertex_data import NO_DATA
from pinwarp.io.meshes import write_mesh
from pinwarp.io.osim.bone import bone_of
from pinwarp.io.osim.reading import read_model
from pinwarp.io.samples import assets_folder, help_folder, sample_model, sample_session
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session

PICTURES = help_folder() / "pictures"
# As wide as the guide's text.
WIDTH = 630


class Studio:
    """A window of the size that the README speaks of, and the camera."""

    def __init__(self) -> None:
        self.window = MainWindow(no_settings())
        self.window.resize(1280, 780)
        self.window.show()

    def sit(self, session: Session) -> None:
        """Show a session as it opens."""
        self.window.editor.replace_all(session, None)
        self.settle()

    def settle(self) -> None:
        """Wait until everything is drawn."""
        wait_until(lambda: self.window.is_settled)
        wait(300)

    def do(self, *keys: str) -> None:
        """Ask for some actions."""
        for key in keys:
            self.window.actions_by_key[key].trigger()
            self.settle()

    def front(self, tab: str) -> None:
        """Bring a panel to the front."""
        dock = self.window.findChild(QWidget, tab)
        dock.show()
        dock.raise_()
        self.settle()

    def around(self, widgets: Iterable[QWidget]) -> QRect:
        """Return where some widgets are in the window."""
        whole = QRect()
        for widget in widgets:
            whole |= QRect(widget.mapTo(self.window, QPoint(0, 0)), widget.size())
        return whole

    def take(self, name: str, widgets: Sequence[QWidget] = (), high: int | None = None) -> None:
        """Keep a picture of the window, or of the part in which some widgets are."""
        picture = self.window.grab()
        part = self.around(widgets) if widgets else picture.rect()
        if high is not None:
            part.setHeight(high)
        keep(picture.copy(part), name)

    def leave(self) -> None:
        """Close without a question."""
        self.window.editor.replace_all(Session(), None)
        self.window.close()


def keep(picture: QPixmap, name: str) -> None:
    """Write a picture, no wider than the guide's text."""
    if picture.width() > WIDTH:
        picture = picture.scaledToWidth(WIDTH, Qt.TransformationMode.SmoothTransformation)
    picture.save(str(PICTURES / f"{name}.png"))
    print(f"{name}: {picture.width()} x {picture.height()}")


def sample() -> Session:
    """Return the sample bones with their landmarks."""
    return read_session(sample_session())


def half_placed(count: int) -> Session:
    """Return the sample of which the last pairs have no destination yet."""
    session = sample()
    for pair in session.pairs[-count:]:
        session = edits.remove_side(session, pair.name, Side.DESTINATION)
    return session


def noisy() -> Session:
    """Return the sample with landmarks that are some millimetres off, as people place them."""
    session, random = sample(), np.random.default_rng(3)
    for pair in session.pairs:
        place = as_position(np.add(pair.destination, random.normal(scale=1.5, size=3)))
        session = edits.move(session, pair.name, Side.DESTINATION, place)
    return session


def of_window(studio: Studio) -> None:
    """Draw what is of the sample's window."""
    views = list(studio.window.viewports.values())
    studio.sit(sample())
    studio.take("window")
    studio.sit(half_placed(6))
    studio.take("ghost", views)
    studio.sit(noisy())
    studio.take("penalty", [studio.window.findChild(QWidget, "penalty")])
    session = sample()
    first, second = session.pairs[9].name, session.pairs[10].name
    studio.sit(edits.swap_destinations(session, first, second))
    studio.take("findings", [studio.window.findChild(QWidget, "landmarks")])
    studio.sit(sample())
    studio.do("map_distance")
    studio.front("map")
    panel = studio.window.findChild(QWidget, "map")
    studio.take("map", [views[1], panel], high=views[1].height())
    studio.do("map_none")
    studio.do("add_whole_patch")
    studio.front("semilandmarks")
    studio.take("semilandmarks", views)


def of_import(studio: Studio) -> None:
    """Draw the question that an import asks."""
    studio.sit(half_placed(16))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "subject.fcsv")
        marks = [pair.placed(Side.SOURCE, None) for pair in sample().pairs]
        metres = [
            x.placed(Side.DESTINATION, as_position(np.multiply(x.destination, 0.001)))
            for x in marks
        ]
        write_landmarks(path, metres, Side.DESTINATION)

        taken = []

        def grab() -> None:
            dialog = QApplication.activeModalWidget()
            # It asks once the file was read and looked at, on a busy machine late.
            if dialog is None or not dialog.isVisible():
                QTimer.singleShot(500, studio.window, grab)
                return
            keep(dialog.grab(), "import")
            taken.append(dialog)
            dialog.reject()

        studio.window.parts.imports.bring_in(path, Side.DESTINATION)
        QTimer.singleShot(2500, studio.window, grab)
        wait_until(lambda: bool(taken))
        studio.settle()


def of_model(studio: Studio) -> None:
    """Draw the small leg with a thigh that is paired."""
    path = sample_model()
    bone = bone_of(read_model(path), "/bodyset/thigh")
    random = np.random.default_rng(0)
    chosen = random.choice(len(bone.mesh.vertices), 12, replace=False)
    longer = np.array([1.1, 1.15, 1.1])
    marks = tuple(
        Landmark(f"place_{i}", as_position(place), as_position(place * longer))
        for i, place in enumerate(bone.mesh.vertices[chosen], 1)
    )
    with tempfile.TemporaryDirectory() as folder:
        subject = Path(folder, "subject_thigh.ply")
        write_mesh(subject, bone.mesh.with_vertices(bone.mesh.vertices * longer), NO_DATA)
        studio.sit(Session())
        studio.window.parts.model.open(path)
        studio.settle()
        tree = studio.window.parts.model.panel.bodies
        (thigh,) = tree.findItems("thigh", Qt.MatchFlag.MatchExactly, 0)
        tree.setCurrentItem(thigh)
        studio.settle()
        studio.window.parts.documents.open_files(Side.DESTINATION, [subject])
        studio.settle()
        session = studio.window.editor.session
        studio.window.editor.commit(replace(session, landmarks=marks), "Pair")
        studio.settle()
        studio.front("model")
        studio.take("model")


def main() -> None:
    """Draw all of them."""
    application = make_application()
    PICTURES.mkdir(exist_ok=True)
    studio = Studio()
    begin(studio.window, Opening(), demo=True)
    studio.settle()
    studio.window.grab().save(str(assets_folder() / "screenshot.png"))
    of_window(studio)
    of_import(studio)
    of_model(studio)
    studio.leave()
    application.processEvents()


if __name__ == "__main__":
    main()
