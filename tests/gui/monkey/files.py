"""Files for the monkey: good ones, damaged ones, and names to save under."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, write_landmarks
from pinwarp.io.meshes import MESH_SUFFIXES, read_mesh, write_mesh
from pinwarp.io.samples import assets_folder, sample_session
from pinwarp.io.session_file import read_session

SESSION, MESH, LANDMARKS = "Sessions", "Meshes", "Landmarks"
# What a name asked for by Save may end in: known, wrong, doubled, none.
_ENDINGS = (*MESH_SUFFIXES, *LANDMARK_SUFFIXES, ".pinwarp.csv", ".html", ".py", ".png", ".gif")
_ODD_NAMES = ("no ending", "two.dots.csv", "Überlänge" + 60 * "x", "a'b\"c", ".hidden", "weird.xyz")


class Files:
    """Good and damaged files in a folder of their own.

    Parameters
    ----------
    folder
        Where they are made.
    rng
        Decides on the damage.
    """

    def __init__(self, folder: Path, rng: random.Random) -> None:
        self.folder = folder
        self._good: dict[str, list[Path]] = {}
        folder.mkdir(parents=True)
        self._make_good()
        self._damaged = {
            kind: [self._damage(path, number, rng) for path in paths for number in range(3)]
            for kind, paths in self._good.items()
        }
        (folder / "sub folder").mkdir()

    def _make_good(self) -> None:
        bones = [
            Path(shutil.copy(assets_folder() / name, self.folder))
            for name in ("femur_generic.ply", "femur_subject.ply")
        ]
        session = Path(shutil.copy(sample_session(), self.folder))
        mesh = read_mesh(bones[0]).mesh
        meshes = list(bones)
        for suffix in MESH_SUFFIXES:
            meshes.append(self.folder / f"bone{suffix}")
            write_mesh(meshes[-1], mesh)
        landmarks = []
        for suffix in LANDMARK_SUFFIXES:
            path = self.folder / f"some{suffix}"
            try:
                write_landmarks(path, read_session(session).landmarks, Side.SOURCE, unit="mm")
            except PinwarpError:
                continue  # not every format is written
            landmarks.append(path)
        self._good = {SESSION: [session], MESH: meshes, LANDMARKS: landmarks}

    def _damage(self, path: Path, number: int, rng: random.Random) -> Path:
        content = bytearray(path.read_bytes())
        if number == 0:
            content = content[: rng.randrange(len(content))]
        elif number == 1:
            for _ in range(1 + len(content) // 500):
                content[rng.randrange(len(content))] = rng.randrange(256)
        else:
            lines = content.split(b"\n")
            rng.shuffle(lines)
            content = bytearray(b"\n".join(lines))
        damaged = path.with_name(f"damaged {number} {path.name}")
        damaged.write_bytes(content)
        return damaged

    def to_open(self, filters: str, rng: random.Random) -> Path:
        """Return a file that is most often of the kind asked for, and most often good."""
        kind = next((kind for kind in self._good if kind in filters), rng.choice(list(self._good)))
        chance = rng.random()
        if chance < 0.6:
            return rng.choice(self._good[kind])
        if chance < 0.85:
            return rng.choice(self._damaged[kind])
        if chance < 0.95:
            # Also what was saved before.
            return rng.choice(sorted(path for path in self.folder.iterdir() if path.is_file()))
        return self.folder / rng.choice(("sub folder", "not there.csv", "sub folder/nothing.ply"))

    def to_save(self, rng: random.Random) -> Path:
        """Return a name to save under, new or taken, fitting or odd."""
        folder = self.folder / "sub folder"
        if rng.random() < 0.15:
            return folder / rng.choice(_ODD_NAMES)
        if rng.random() < 0.1:
            return self.folder / "no such folder" / "x.csv"
        return folder / f"saved {rng.randrange(4)}{rng.choice(_ENDINGS)}"
