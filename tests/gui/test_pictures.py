"""User stories: pictures and animations of the views."""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType

import numpy as np
import pytest
from PIL import Image
from qtpy.QtCore import Qt
from qtpy.QtGui import QImage
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication

from pinwarp.core.components import Components
from pinwarp.core.landmarks import Side
from pinwarp.gui.exporting.animation import AnimationOrder, Motion, animation_steps, ends_of
from pinwarp.gui.exporting.offscreen import Offscreen
from pinwarp.gui.exporting.picture_dialogs import AnimationDialog, PictureDialog
from pinwarp.gui.scene.drawables import Arrows, FoldedSurface, GridLines, Overlay
from pinwarp.io.animation import has_encoder
from pinwarp.session import edits
from pinwarp.session.warp.provenance import session_hash

DESTINATION = Side.DESTINATION


@pytest.fixture
def sample(user):
    user.open_sample()
    return user


def dialog_of(user, key, kind):
    user.window.actions_by_key[key].trigger()
    return next(x for x in user.window.findChildren(kind) if x.isVisible())


def type_into(box, value):
    box.selectAll()
    QTest.keyClicks(box, str(value))
    QTest.keyClick(box, Qt.Key.Key_Tab)


def choose(combo, row):
    combo.setFocus()
    QTest.keyClick(combo, Qt.Key.Key_Home)
    for _ in range(row):
        QTest.keyClick(combo, Qt.Key.Key_Down)


def press(user, dialog, settle=True):
    QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)
    if settle:
        user.settle()


def picture(user, path, width, height, *, view=0, off=(), on=()):
    """Order a picture as a user does and return its pixels."""
    dialog = dialog_of(user, "export_picture", PictureDialog)
    type_into(dialog.image_width, width)
    type_into(dialog.image_height, height)
    choose(dialog.view, view)
    if "filled" not in on:
        off = (*off, "filled")
    for name in (*off, *on):
        box = getattr(dialog, name)
        if box.isChecked() != (name in on):
            QTest.keyClick(box, Qt.Key.Key_Space)
    user.dialogs.saves = [path]
    press(user, dialog)
    with Image.open(path) as found:
        return np.asarray(found.convert("RGBA"))


def grabbed(widget) -> np.ndarray:
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGBA8888)
    return np.frombuffer(image.bits(), np.uint8).reshape(image.height(), image.width(), 4).copy()


def test_a_picture_of_the_views_own_size_is_what_the_window_shows(sample, tmp_path):
    view = sample.window.viewports[DESTINATION]
    shown = grabbed(view).astype(int)
    path = tmp_path / "bone.png"
    height, width = shown.shape[:2]
    found = picture(sample, path, width, height, view=2).astype(int)
    assert found.shape == shown.shape
    # Edges are smoothed in another way.
    assert (np.abs(found - shown).max(axis=2) > 24).mean() < 0.01
    assert np.abs(found - shown).mean() < 1
    message = sample.window.statusBar().currentMessage()
    assert f"{width} × {height} pixels, the full warp" in message
    with Image.open(path) as told:
        assert session_hash(sample.session) in told.text["Description"]


def test_a_large_picture_is_rendered_and_not_enlarged(sample, tmp_path):
    """Four times as many pixels across show edges that a small one enlarged has not."""
    view = sample.window.viewports[DESTINATION]
    width, height = view.width(), view.height()
    hide = {"off": ("landmarks", "framed"), "on": ("transparent",), "view": 2}
    large = picture(sample, tmp_path / "large.png", 4 * width, 4 * height, **hide)
    small = picture(sample, tmp_path / "small.png", width, height, **hide)
    enlarged = np.asarray(Image.fromarray(small).resize((4 * width, 4 * height), Image.BILINEAR))
    partly = ((large[..., 3] > 8) & (large[..., 3] < 247)).mean()
    partly_enlarged = ((enlarged[..., 3] > 8) & (enlarged[..., 3] < 247)).mean()
    assert partly < 0.5 * partly_enlarged
    # The same bone at the same place.
    both = (large[..., 3] > 127) & (enlarged[..., 3] > 127)
    either = (large[..., 3] > 127) | (enlarged[..., 3] > 127)
    assert both.sum() / either.sum() > 0.98


def test_a_picture_of_another_shape_shows_all_that_the_window_shows(sample, tmp_path):
    view = sample.window.viewports[Side.SOURCE]
    hide = {"off": ("landmarks", "framed"), "on": ("transparent",), "view": 1}
    height = view.height()
    wide = picture(sample, tmp_path / "wide.png", 3 * view.width(), height, **hide)
    same = picture(sample, tmp_path / "same.png", view.width(), height, **hide)
    middle = wide[:, view.width() : 2 * view.width()].astype(int)
    assert (np.abs(middle - same).max(axis=2) > 24).mean() < 0.005
    assert wide[:, : view.width(), 3].max() == 0


def test_both_views_stand_side_by_side(sample, tmp_path):
    found = picture(sample, tmp_path / "both.png", 801, 600, off=("landmarks", "framed"))
    assert found.shape == (600, 801, 4)
    halves = found[:, :400], found[:, 400:]
    # Ivory is warmer than grey.
    warmth = [half[..., 0].astype(int) - half[..., 2] for half in halves]
    assert (warmth[0] > 20).mean() > 0.02
    assert (warmth[1] > 20).mean() < 0.001


def test_landmarks_and_the_background_can_be_left_out(sample, tmp_path):
    green = [0, 0x9E, 0x73]

    def discs(pixels):
        return (np.abs(pixels[..., :3].astype(int) - green).max(axis=2) < 6).sum()

    shown = picture(sample, tmp_path / "a.png", 800, 600, on=("landmarks",))
    assert discs(shown) > 300
    assert shown[..., 3].min() == 255
    bare = picture(
        sample, tmp_path / "b.png", 800, 600, off=("landmarks", "framed"), on=("transparent",)
    )
    assert discs(bare) == 0
    assert (bare[..., 3] == 0).mean() > 0.5
    # What was chosen last is proposed again.
    dialog = dialog_of(sample, "export_picture", PictureDialog)
    assert dialog.transparent.isChecked()
    assert not dialog.landmarks.isChecked()
    assert not dialog.names.isEnabled()
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


def test_names_stand_beside_the_landmarks_in_front(sample, tmp_path):
    plain = picture(sample, tmp_path / "a.png", 800, 600, view=2, off=("names",)).astype(int)
    named = picture(sample, tmp_path / "b.png", 800, 600, view=2, on=("names",)).astype(int)
    layer = sample.window.viewports[DESTINATION].layer
    changed = (np.abs(named - plain).max(axis=2) > 40).any(axis=1)
    scale = 600 / layer.height()
    for place, hidden in zip(layer.places(), layer.hidden(), strict=True):
        if not hidden:
            assert changed[round(place[1] * scale)]
    # Nothing of that stays in the window.
    assert not any(marker.labelled for marker in layer.markers)
    assert np.isfinite(layer.places()).all()


def test_arrows_and_the_grid_are_in_the_picture_where_the_window_shows_them(sample, tmp_path):
    size = {"view": 2, "off": ("names",)}
    plain = picture(sample, tmp_path / "a.png", 800, 600, **size).astype(int)
    sample.trigger("grid_box")
    gridded = picture(sample, tmp_path / "b.png", 800, 600, **size).astype(int)
    assert apart(plain, gridded) > 0.01
    # A residual so long that its arrow reaches beyond the landmark's sign.
    pair = sample.session.pairs[0]
    moved = edits.move(sample.session, pair.name, DESTINATION, (pair.destination[0] + 80, 0, 0))
    sample.editor.commit(edits.set_penalty(moved, np.inf), "Change penalty")
    sample.settle()
    assert sample.window.viewports[DESTINATION].drawn(Arrows)
    shown = picture(sample, tmp_path / "c.png", 800, 600, **size).astype(int)
    sample.trigger("arrows")
    assert not sample.window.viewports[DESTINATION].drawn(Arrows)
    hidden = picture(sample, tmp_path / "d.png", 800, 600, **size).astype(int)
    assert apart(shown, hidden) > 0.0002


def test_a_map_comes_with_its_legend(sample, tmp_path):
    sample.trigger("map_distance")
    view = sample.window.viewports[DESTINATION]
    legend, shown = view.map_legend.geometry(), grabbed(view).astype(int)
    found = picture(
        sample, tmp_path / "map.png", view.width(), view.height(), view=2, off=("landmarks",)
    ).astype(int)

    def part(image):
        return image[legend.top() : legend.bottom(), legend.left() : legend.right(), :3]

    assert np.abs(part(found) - part(shown)).mean() < 3
    wide = picture(
        sample, tmp_path / "wide.png", 2 * view.width(), view.height(), view=2, off=("landmarks",)
    ).astype(int)
    moved = wide[legend.top() : legend.bottom(), view.width() :][:, legend.left() : legend.right()]
    assert np.abs(moved[..., :3] - part(shown)).mean() < 3, "it keeps to the right edge"


def test_the_session_may_go_on_while_a_picture_is_rendered(sample, tmp_path):
    """The picture is of the moment when it was ordered."""
    quiet = {"view": 2, "off": ("framed",)}
    first = picture(sample, tmp_path / "a.png", 900, 700, **quiet)
    dialog = dialog_of(sample, "export_picture", PictureDialog)
    sample.dialogs.saves = [tmp_path / "b.png"]
    press(sample, dialog, settle=False)
    QApplication.processEvents()
    assert not sample.window.stepped.is_idle
    sample.editor.commit(edits.set_components(sample.session, Components.RIGID), "Apply")
    sample.window.actions_by_key["view_back"].trigger()
    sample.settle()
    with Image.open(tmp_path / "b.png") as found:
        assert np.array_equal(np.asarray(found.convert("RGBA")), first)


def test_tiles_fit_together(sample):
    view = sample.window.viewports[DESTINATION]
    pictures = []
    for tile in (1000, 130):
        copy = Offscreen(view, view.scene, tile)
        whole = np.zeros((333, 500, 4), np.uint8)
        for part in copy.tiles(500, 333):
            part.put_into(whole)
        copy.close()
        pictures.append(whole.astype(int))
    assert pictures[0][..., 3].max() == 255
    assert np.abs(pictures[0] - pictures[1]).max() <= 3


def test_too_many_pixels_are_refused_before_the_work(sample):
    dialog = dialog_of(sample, "export_picture", PictureDialog)
    type_into(dialog.image_width, 16000)
    type_into(dialog.image_height, 16000)
    assert "256.0 million pixels are too many" in dialog.note.text()
    assert not dialog.export.isEnabled()
    type_into(dialog.image_height, 6000)
    assert dialog.export.isEnabled()
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


@pytest.mark.parametrize(("key", "kind"), [("export_picture", "png"), ("export_animation", "gif")])
def test_what_cannot_be_written_is_told_and_leaves_nothing(sample, tmp_path, key, kind):
    dialog = dialog_of(sample, key, PictureDialog if kind == "png" else AnimationDialog)
    type_into(dialog.image_width, 100)
    type_into(dialog.image_height, 100)
    sample.dialogs.saves = [tmp_path / "nowhere" / f"bone.{kind}"]
    press(sample, dialog)
    ((_, text),) = sample.dialogs.errors
    assert "No such file" in text
    assert list(tmp_path.iterdir()) == []


# Animations


def animation(user, path, *, motion, size=160, frames=12):
    dialog = dialog_of(user, "export_animation", AnimationDialog)
    choose(dialog.motion, motion)
    type_into(dialog.image_width, size)
    type_into(dialog.image_height, size)
    type_into(dialog.frames, frames)
    type_into(dialog.seconds, 2)
    user.dialogs.saves = [path]
    press(user, dialog)
    with Image.open(path) as found:
        pictures = []
        for number in range(found.n_frames):
            found.seek(number)
            pictures.append(np.asarray(found.convert("RGB")).astype(int))
    return pictures


def apart(a, b) -> float:
    return float((np.abs(a - b).max(axis=2) > 24).mean())


def test_a_turn_shows_the_bone_from_all_sides_and_ends_where_it_began(sample, tmp_path):
    pose = sample.window.viewports[DESTINATION].camera.GetPosition()
    frames = animation(sample, tmp_path / "turn.gif", motion=0)
    assert len(frames) == 12
    steps = [apart(a, b) for a, b in zip(frames, frames[1:] + frames[:1], strict=True)]
    assert min(steps) > 0.003
    # The last step back to the first is as small as the others.
    assert steps[-1] < 2.5 * np.median(steps)
    assert apart(frames[0], frames[6]) > 0.01
    assert sample.window.viewports[DESTINATION].camera.GetPosition() == pose
    assert "12 frames in 2 s, the full warp" in sample.window.statusBar().currentMessage()


def test_a_blend_goes_from_the_aligned_source_to_the_warp_and_back(sample, tmp_path):
    frames = animation(sample, tmp_path / "blend.gif", motion=1)
    assert len(frames) == 12
    to_warp = [apart(frame, frames[6]) for frame in frames]
    assert to_warp[0] == max(to_warp) > 0.02
    assert to_warp[:7] == sorted(to_warp[:7], reverse=True)
    for number in range(1, 6):
        assert apart(frames[number], frames[12 - number]) < 0.002
    warped = picture(
        sample, tmp_path / "w.png", 160, 160, view=2, off=("landmarks", "framed", "transparent")
    )
    assert apart(frames[6], warped[..., :3].astype(int)) < 0.01


def test_a_blend_leaves_out_what_belongs_to_the_whole_warp_and_would_stand_still(
    sample, monkeypatch
):
    view, shown = sample.window.viewports[DESTINATION], []
    vertices = view.drawn(Overlay).full.vertices
    folded = FoldedSurface(vertices[:3], np.array([[0, 1, 2]]), np.array([[0, 1], [1, 2], [0, 2]]))
    view.show_scene(view.scene.with_(folded, GridLines(np.zeros((2, 3, 3)))))
    monkeypatch.setattr(Offscreen, "show", lambda _copy, scene: shown.append(scene))
    order = AnimationOrder(Motion.BLEND, 32, 32, frames=4)
    for _ in animation_steps(order, view, ends_of(sample.session)):
        pass
    assert len(shown) == 4
    for scene in shown:
        assert scene.of(FoldedSurface) is None
        assert scene.of(GridLines) is None
        assert scene.of(Overlay).visible
    assert np.allclose(shown[2].of(Overlay).full.vertices, vertices, atol=1e-3)
    assert not np.allclose(shown[0].of(Overlay).full.vertices, vertices, atol=1e-3)
    assert view.drawn(Overlay).full.vertices is vertices, "the window's own stays as it is"


def test_an_animation_of_a_map_has_its_legend_in_every_frame(sample, tmp_path):
    view = sample.window.viewports[DESTINATION]
    bare = animation(sample, tmp_path / "bare.gif", motion=0, size=480, frames=3)
    sample.trigger("map_distance")
    ordered = picture(sample, tmp_path / "map.png", 480, 480, view=2, off=("landmarks",))
    frames = animation(sample, tmp_path / "map.gif", motion=0, size=480, frames=3)
    scale = 480 / view.height()
    legend = view.map_legend.geometry()
    right = 480 - round((view.width() - legend.left()) * scale)
    part = np.s_[round(legend.top() * scale) + 4 : round(legend.bottom() * scale) - 4, right + 4 :]
    shown = ordered[part][..., :3].astype(int)
    for frame, before in zip(frames, bare, strict=True):
        # A GIF has 256 colours.
        assert np.abs(frame[part] - shown).mean() < 8
        assert apart(frame[part], before[part]) > 0.05


def test_a_picture_cut_to_the_bones_is_filled_by_them(sample, tmp_path):
    def filled(pixels):
        rows, columns = np.nonzero(pixels[..., 3] > 127)
        height, width = pixels.shape[:2]
        return np.ptp(rows) / height, np.ptp(columns) / width

    dialog = dialog_of(sample, "export_picture", PictureDialog)
    assert dialog.filled.isChecked()
    # Two femora side by side, and one alone: the size follows, until somebody chooses one.
    both = dialog.image_width.value() / dialog.image_height.value()
    choose(dialog.view, 1)
    one = dialog.image_width.value() / dialog.image_height.value()
    assert max(dialog.image_width.value(), dialog.image_height.value()) == 2400
    assert one < 0.6 * both
    for box in (dialog.landmarks, dialog.framed, dialog.transparent):
        if box.isChecked() != (box is dialog.transparent):
            QTest.keyClick(box, Qt.Key.Key_Space)
    sample.dialogs.saves = [tmp_path / "bone.png"]
    press(sample, dialog)
    with Image.open(tmp_path / "bone.png") as found:
        high, wide = filled(np.asarray(found))
    assert high > 0.9
    assert wide > 0.7
    dialog = dialog_of(sample, "export_picture", PictureDialog)
    type_into(dialog.image_width, 700)
    choose(dialog.view, 0)
    assert dialog.image_width.value() == 700
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


def test_the_same_place_is_under_its_landmark_in_a_picture_cut_to_the_bones(sample, tmp_path):
    """Bones are rendered and landmarks painted in two ways: both know the part that is shown."""
    shown = {"view": 2, "off": ("framed", "names"), "on": ("filled", "landmarks")}
    found = picture(sample, tmp_path / "a.png", 500, 900, **shown)
    green = np.abs(found[..., :3].astype(int) - [0, 0x9E, 0x73]).max(axis=2) < 6
    bare = {"view": 2, "off": ("framed", "landmarks"), "on": ("filled", "transparent")}
    bone = picture(sample, tmp_path / "b.png", 500, 900, **bare)[..., 3] > 127
    # Nearly all of each sign lies on the bone.
    assert green.sum() > 300
    assert (green & bone).sum() > 0.6 * green.sum()


def test_what_would_not_move_is_refused(sample, tmp_path):
    sample.editor.commit(edits.set_components(sample.session, Components.RIGID), "Apply")
    sample.settle()
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    choose(dialog.motion, 1)
    sample.dialogs.saves = [tmp_path / "a.gif"]
    press(sample, dialog)
    assert "nothing would move" in sample.dialogs.errors[0][1]
    assert list(tmp_path.iterdir()) == []


def test_an_animation_can_be_cancelled_while_the_window_lives(sample, tmp_path):
    window = sample.window
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    sample.dialogs.saves = [tmp_path / "a.gif"]
    press(sample, dialog, settle=False)
    sample.qtbot.waitUntil(window.cancel.isVisible, timeout=30_000)
    sample.qtbot.waitUntil(lambda: window.progress.value() >= 2, timeout=30_000)
    QTest.mouseClick(window.cancel, Qt.MouseButton.LeftButton)
    sample.settle()
    assert "Cancelled" in window.statusBar().currentMessage()
    assert not window.progress.isVisible()
    assert list(tmp_path.iterdir()) == []


def test_a_window_may_be_closed_while_an_animation_is_rendered(sample, tmp_path):
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    sample.dialogs.saves = [tmp_path / "a.gif"]
    press(sample, dialog, settle=False)
    QApplication.processEvents()
    assert not sample.window.stepped.is_idle
    sample.window.close()
    assert sample.window.stepped.is_idle


def test_more_than_gif_can_show_is_refused_before_the_work(sample):
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    type_into(dialog.frames, 250)
    assert "at most 50 frames a second" in dialog.note.text()
    assert not dialog.export.isEnabled()
    type_into(dialog.seconds, 10)
    assert dialog.export.isEnabled()
    type_into(dialog.image_width, 2000)
    assert "too much for the memory" in dialog.note.text()
    assert not dialog.export.isEnabled()
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


@pytest.mark.skipif(not has_encoder(), reason="needs the extra 'video'")
def test_an_animation_can_be_an_mp4(sample, tmp_path):
    import imageio_ffmpeg

    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    choose(dialog.format, 1)
    type_into(dialog.image_width, 161)
    type_into(dialog.image_height, 160)
    type_into(dialog.frames, 8)
    type_into(dialog.seconds, 1)
    sample.dialogs.saves = [tmp_path / "turn"]
    press(sample, dialog)
    assert sample.dialogs.errors == []
    assert imageio_ffmpeg.count_frames_and_secs(tmp_path / "turn.mp4")[0] == 8
    assert "turn.mp4: 8 frames in 1 s" in sample.window.statusBar().currentMessage()


def test_where_no_encoder_is_the_choice_says_how_to_get_one(sample, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    assert dialog.export.isEnabled()
    choose(dialog.format, 1)
    assert "pip install" in dialog.note.text()
    assert "pinwarp[video]" in dialog.note.text()
    assert not dialog.export.isEnabled()
    choose(dialog.format, 0)
    assert dialog.export.isEnabled()
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


def test_an_encoder_that_fails_is_told_and_leaves_nothing(sample, tmp_path, monkeypatch):
    def missing():
        raise RuntimeError("no ffmpeg exe could be found")

    stand_in = ModuleType("imageio_ffmpeg")
    stand_in.get_ffmpeg_exe = missing
    stand_in.__spec__ = ModuleSpec("imageio_ffmpeg", None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", stand_in)
    dialog = dialog_of(sample, "export_animation", AnimationDialog)
    choose(dialog.format, 1)
    type_into(dialog.image_width, 64)
    type_into(dialog.image_height, 64)
    type_into(dialog.frames, 2)
    sample.dialogs.saves = [tmp_path / "turn.mp4"]
    press(sample, dialog)
    ((_, text),) = sample.dialogs.errors
    assert "The encoder does not start (no ffmpeg exe could be found)" in text
    assert list(tmp_path.iterdir()) == []
