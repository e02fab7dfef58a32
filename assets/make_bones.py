"""Make the two sample femurs and the sample landmark session of pinwarp.

Both bones are right femurs in millimetres, made from anatomy as implicit surfaces; no scan is
involved.  Axes before a bone is put in its pose: +x lateral, +y anterior, +z proximal, the
condyles standing on z = 0 and the centre of the head above the middle of the knee.

Three frames are used: ``shaft`` (origin mid-knee, z along the shaft), ``proximal`` (origin where
the axes of neck and shaft meet, turned by the torsion, sized by the head) and ``distal`` (origin
mid-knee, condyles level, sized by the condyles).  Lengths written below are those of a bone with
a 47 mm head and epicondyles 85 mm apart.  The shaft is straight in all frames and bowed last.

Run as ``python assets/make_bones.py``; the files it writes are the same bytes every time.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyvista as pv
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

HERE = Path(__file__).resolve().parent
VOXEL = 1.2
N_VERTICES = 10_000


@dataclass(frozen=True)
class Femur:
    """What makes one femur differ from another (millimetres and degrees)."""

    length: float
    head_diameter: float
    neck_length: float
    neck_angle: float
    torsion: float
    bow: float
    shaft_girth: float  # 1 is a midshaft 27 mm wide
    condyle_width: float  # from epicondyle to epicondyle
    condyle_depth: float
    turn: tuple[float, float, float]  # pose: about x, y and then z
    shift: tuple[float, float, float]

    @property
    def proximal_scale(self) -> float:
        """Size of the proximal end."""
        return self.head_diameter / 47.0

    @property
    def neck_axis(self) -> np.ndarray:
        """Unit vector from shaft to head in the proximal frame."""
        lean = np.radians(180.0 - self.neck_angle)
        return np.array([-np.sin(lean), 0.0, np.cos(lean)])

    @property
    def head_centre(self) -> np.ndarray:
        """Centre of the head in the proximal frame, in its units."""
        return self.neck_axis * self.neck_length / self.proximal_scale

    @property
    def obliquity(self) -> float:
        """Angle of shaft and mechanical axis (radians); it brings the head above the knee."""
        medial = -self.neck_axis[0] * self.neck_length * np.cos(np.radians(self.torsion))
        return float(np.arcsin(medial / (self.length - self.head_diameter / 2)))

    @property
    def shaft_top(self) -> float:
        """Height along the shaft at which its axis meets that of the neck."""
        to_head = (self.length - self.head_diameter / 2) * np.cos(self.obliquity)
        return float(to_head - self.neck_axis[2] * self.neck_length)

    def bowed(self, z: np.ndarray) -> np.ndarray:
        """Anterior displacement of the shaft axis at height z."""
        low, high = -10.0, self.shaft_top + 30.0
        t = (np.clip(z, low, high) - low) / (high - low)
        beyond = (np.clip(z, None, low) - low - np.clip(z, high, None) + high) / (high - low)
        return self.bow * 4.0 * (t * (1.0 - t) + beyond)

    def frame(self, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rotation, scale and origin that take a frame to the (straight) shaft frame."""
        if name == "proximal":
            turn = Rotation.from_euler("z", -self.torsion, degrees=True).as_matrix()
            return turn, np.full(3, self.proximal_scale), np.array([0.0, 0.0, self.shaft_top])
        if name == "distal":
            tilt = Rotation.from_euler("y", -self.obliquity).as_matrix()
            width, depth = self.condyle_width / 85.0, self.condyle_depth / 64.0
            return tilt, np.array([width, depth, depth]), np.zeros(3)
        if name == "head":
            turn, scale, _ = self.frame("proximal")
            return turn, scale, self.to_shaft("proximal", self.head_centre)
        if name == "neck":
            turn, scale, origin = self.frame("proximal")
            x, _, z = self.neck_axis
            along = np.array([[z, 0.0, x], [0.0, 1.0, 0.0], [-x, 0.0, z]])
            return turn @ along, scale * (1.0, 1.0, np.linalg.norm(self.head_centre)), origin
        return np.eye(3), np.array([1.0, 1.0, self.shaft_top]), np.zeros(3)

    def to_shaft(self, name: str, points: Sequence) -> np.ndarray:
        """Take points of a frame to the straight shaft frame."""
        turn, scale, origin = self.frame(name)
        return np.asarray(points, float) * scale @ turn.T + origin

    def to_world(self, straight: np.ndarray) -> np.ndarray:
        """Bow straight shaft-frame points and put them in the pose of the bone."""
        bent = straight + np.outer(self.bowed(straight[:, 2]), [0.0, 1.0, 0.0])
        return self.pose(bent)

    def pose(self, bent: np.ndarray) -> np.ndarray:
        """Stand bowed shaft-frame points on the condyles, then turn and shift them."""
        stand = Rotation.from_euler("y", self.obliquity)
        turn = Rotation.from_euler("xyz", self.turn, degrees=True)
        return (turn * stand).apply(bent) + self.shift


GENERIC = Femur(
    length=430, head_diameter=47, neck_length=56, neck_angle=127, torsion=12, bow=15,
    shaft_girth=1.0, condyle_width=82, condyle_depth=64, turn=(0, 0, 0), shift=(0, 0, 0),
)  # fmt: skip
SUBJECT = Femur(
    length=395, head_diameter=45, neck_length=52, neck_angle=135, torsion=25, bow=9,
    shaft_girth=1.04, condyle_width=80, condyle_depth=59, turn=(5, -1.5, 22), shift=(110, -25, 40),
)  # fmt: skip

FOVEA = np.array([-0.92, -0.32, 0.22])  # direction from the centre of the head


def join(a: np.ndarray, b: np.ndarray, k: float) -> np.ndarray:
    """Union of two fields with a fillet about k wide."""
    return np.minimum(a, b) - np.maximum(k - np.abs(a - b), 0.0) ** 2 / (4.0 * k)


def cut(a: np.ndarray, b: np.ndarray, k: float) -> np.ndarray:
    """Remove b from a, leaving a rim rounded over about k."""
    return -join(-a, b, k)


def ellipsoid(p: np.ndarray, centre: Sequence, radii: Sequence) -> np.ndarray:
    """Signed distance (nearly) to an ellipsoid along the axes; p is 3 x n."""
    q = (p - np.array(centre, "f4")[:, None]) / np.array(radii, "f4")[:, None]
    slope = np.sqrt(((q / np.array(radii, "f4")[:, None]) ** 2).sum(0))
    length = np.sqrt((q**2).sum(0))
    return np.where(length > 1e-3, length * (length - 1.0) / np.maximum(slope, 1e-9), -min(radii))


def ridge(p: np.ndarray, knots: Sequence) -> np.ndarray:
    """Signed distance to balls strung on a polyline; each knot is (x, y, z, radius)."""
    field = np.full(p.shape[1], np.inf, "f4")
    for a, b in pairwise(np.array(knots, "f4")):
        step = b[:3] - a[:3]
        from_a = p - a[:3, None]
        h = np.clip(step @ from_a / (step @ step), 0.0, 1.0)
        away = np.sqrt(((from_a - step[:, None] * h) ** 2).sum(0))
        np.minimum(field, away - a[3] - (b[3] - a[3]) * h, out=field)
    return field


def tube(p: np.ndarray, knots: Sequence) -> np.ndarray:
    """Signed distance to elliptic sections along z; knots are (z, half x, half y, mid x, mid y)."""
    table = np.array(knots, float)
    z = p[2]
    at = np.clip(z, table[0, 0], table[-1, 0])
    half_x, half_y, mid_x, mid_y = PchipInterpolator(table[:, 0], table[:, 1:])(at).T.astype("f4")
    wall = ellipsoid(np.stack([(p[0] - mid_x) / half_x, (p[1] - mid_y) / half_y]), (0, 0), (1, 1))
    wall *= np.minimum(half_x, half_y)
    return np.where(z == at, wall, np.hypot(np.maximum(wall, 0.0), z - at)).astype("f4")


def condyle(
    p: np.ndarray, line: Sequence, back: Sequence, front: Sequence, half: float
) -> np.ndarray:
    """Shape a rounded slab with the sagittal outline of a condyle.

    `line` is x at y = 0 and its change with y; `back` and `front` are circles (y, z, radius).
    """
    flat = np.stack([p[1], p[2], np.zeros_like(p[0])])
    outline = ridge(flat, [(*back[:2], 0, back[2]), (*front[:2], 0, front[2])])
    round_off = 12.5
    side = np.abs(p[0] - line[0] - line[1] * p[1]) - half + round_off
    rim = outline + round_off
    outside = np.hypot(np.maximum(side, 0.0), np.maximum(rim, 0.0))
    return outside + np.minimum(np.maximum(side, rim), 0.0) - round_off


def mould(field: np.ndarray, p: np.ndarray, knots: Sequence, width: float) -> np.ndarray:
    """Raise (or, below zero, hollow) the surface along a polyline near it.

    Each knot is (x, y, z, height); the swelling fades over `width` to either side.
    """
    table = np.array(knots, "f4")
    raised = np.zeros_like(field)
    for a, b in pairwise(table):
        step = b[:3] - a[:3]
        from_a = p - a[:3, None]
        h = np.clip(step @ from_a / (step @ step), 0.0, 1.0)
        away = ((from_a - step[:, None] * h) ** 2).sum(0)
        swelling = (a[3] + (b[3] - a[3]) * h) * np.exp(-away / width**2)
        raised = np.where(np.abs(swelling) > np.abs(raised), swelling, raised)
    return field - raised


def shaft_field(bone: Femur, p: np.ndarray) -> np.ndarray:
    """Field of the shaft with the linea aspera, in the straight shaft frame."""
    top, girth = bone.shaft_top, bone.shaft_girth
    d, w, s = bone.condyle_depth / 64.0, bone.condyle_width / 85.0, bone.proximal_scale
    body = tube(
        p,
        [
            (28 * d, 33 * w, 17 * d, -3 * w, -4 * d),
            (42 * d, 35 * w, 18.5 * d, -4 * w, -3 * d),
            (56 * d, 31.5 * w, 18.5 * d, -4 * w, -1 * d),
            (75 * d, 24.5 * w, 17 * d, -2.5 * w, 0),
            (100 * d, 18.5 * w, 15 * d, -1.2 * w, 0),
            (0.38 * top, 14.2 * girth, 13.6 * girth, 0, 0),
            (0.55 * top, 13.2 * girth, 13.2 * girth, 0, 0),
            (0.72 * top, 13.4 * girth, 13.2 * girth, 0, 0),
            (top - 60 * s, 15 * s, 13.6 * s, 0, 0),
            (top - 25 * s, 17.5 * s, 14.5 * s, 0.5 * s, 0),
            (top + 4 * s, 18 * s, 14 * s, 2 * s, 0),
        ],
    )
    # flatter flanks behind make the section a rounded triangle that ends in the linea aspera
    back = -13.2 * girth
    flank = [(10.5, back + 4, 0.3 * top, 0), (10.5, back + 4, 0.5 * top, -1.2)]
    flank += [(10.5, back + 4, 0.72 * top, 0)]
    body = mould(body, p, flank, 7.0)
    body = mould(body, p, np.array(flank) * (-1, 1, 1, 1), 7.0)
    aspera = [(1, back, 0.26 * top, 0), (1, back, 0.38 * top, 2.2), (1, back, 0.52 * top, 3.4)]
    aspera += [(1, back, 0.66 * top, 2.6), (1, back, 0.82 * top, 0)]
    body = mould(body, p, aspera, 4.5)
    for side in (-1.0, 1.0):  # the supracondylar lines
        line = [(1, back, 0.36 * top, 1), (side * 11, -13.5 * d, 95 * d, 1.4)]
        line += [(side * 24 * w - 3, -11 * d, 58 * d, 0.8)]
        body = mould(body, p, line, 4.0)
    return body


def proximal_field(bone: Femur, p: np.ndarray, shaft: np.ndarray) -> np.ndarray:
    """Add neck, trochanters and their lines to the shaft; all in the proximal frame."""
    axis = bone.neck_axis
    long = float(np.linalg.norm(bone.head_centre))
    # the neck frame: z along the neck, y anterior, x towards the upper side
    along = np.stack([[axis[2], 0, -axis[0]], [0, 1, 0], axis]).astype("f4")
    neck = tube(
        along @ p,
        [
            (-6, 18, 13, 0, 0),
            (0.2 * long, 18, 13.5, 0, 0),
            (0.45 * long, 16.5, 13, 0, 0.5),
            (0.66 * long, 15.4, 13.2, 0, 0.5),
            (long, 17, 16, 0, 0),
        ],
    )
    trochanter = join(
        ellipsoid(p, (10, 0, 3), (15, 17.5, 25)),
        ridge(p, [(12, 7, 8, 11), (14, -2, 15, 11), (13, -9, 21, 9.5), (10.5, -12, 25.5, 7.5)]),
        12.0,
    )
    field = join(shaft, neck, 20.0)
    field = join(field, trochanter, 12.0)
    lesser = ridge(p, [(-5, -6, -36, 11), (-13.5, -15.5, -37, 5.5)])
    field = join(field, lesser, 10.0)
    crest = [(10, -20, 24, 1), (8, -21, 8, 4), (1, -19, -10, 4), (-8, -17, -28, 3)]
    field = mould(field, p, crest, 7.0)
    field = cut(field, ellipsoid(p, (-0.5, -16.5, 13), (5.5, 8, 8)), 11.0)
    line = [(12, 16, 14, 1), (2, 15, -4, 1.6), (-9, 13, -22, 1.4), (-15, 5, -42, 0.8)]
    field = mould(field, p, [*line, (-10, -8, -62, 0.6), (-3, -13, -85, 0)], 4.0)
    field = mould(field, p, [(22, -6, -20, 0), (21, 6, -12, 1.2), (14, 15, 2, 0.8)], 5.0)
    gluteal = [(12, -12, -26, 0), (10, -12, -50, 2.2), (6, -13, -75, 1.8), (2, -13, -105, 0)]
    return mould(field, p, gluteal, 5.0)


def distal_field(p: np.ndarray, shaft: np.ndarray) -> np.ndarray:
    """Add condyles, trochlea and epicondyles to the shaft; all in the distal frame."""
    medial = condyle(p, (-20, 0.22), (-21, 21.5, 21.5), (-6, 26, 26), 15)
    lateral = condyle(p, (21, -0.1), (-20, 22.5, 20.5), (-3, 28, 26), 14.5)
    floor = ridge(p, [(-16, -4, 29, 20), (16, -3, 29, 20.5)])
    lips = np.minimum(
        ridge(p, [(21, 12, 16, 10), (18, 15, 28, 10), (15, 14, 42, 9), (12, 9, 58, 7)]),
        ridge(p, [(-19, 7, 15, 10), (-17, 9.5, 26, 9.5), (-14, 8, 38, 9), (-11, 4, 50, 7)]),
    )
    field = join(shaft, floor, 8.0)
    field = join(field, np.minimum(medial, lateral), 10.0)
    field = join(field, lips, 9.0)
    # the popliteal surface is flat, a little hollow
    field = cut(field, ellipsoid(p, (0, -62, 74), (60, 47, 42)), 6.0)
    field = join(field, ellipsoid(p, (-24.5, -13, 29), (12, 18, 19)), 12.0)
    field = join(field, ellipsoid(p, (24.5, -12, 29), (12, 17, 18)), 12.0)
    field = mould(field, p, [(-38, -13, 32, 2.4), (-37, -12, 34, 2.4)], 6.0)
    field = mould(field, p, [(38, -12, 31, 2.4), (37, -11, 33, 2.4)], 6.0)
    field = mould(field, p, [(-37, -19, 46, 2.5), (-34, -18, 52, 2.5)], 6.0)
    # intercondylar notch: a vault whose roof climbs backwards
    vault = PchipInterpolator(
        [-60, -45, -30, -15, 0, 9, 14],
        [(34, 13), (29, 12), (24, 10.5), (16, 10), (4, 9), (-8, 7), (-20, 3)],
    )
    spring, radius = vault(np.clip(p[1], -60, 14)).T.astype("f4")
    field = cut(field, np.hypot(p[0], np.maximum(p[2] - spring, 0.0)) - radius, 8.0)
    # the groove of the popliteus tendon, below and behind the lateral epicondyle
    return mould(field, p, [(36, -30, 24, -0.8), (38, -21, 19, -1.4), (37, -10, 15, -0.8)], 4.0)


def head_centre(bone: Femur) -> np.ndarray:
    """Centre of the head in the bowed shaft frame."""
    centre = bone.to_shaft("proximal", bone.head_centre)
    centre[1] += bone.bowed(centre[2])
    return centre


def fine_surface(bone: Femur) -> pv.PolyData:
    """Contour the bone finely, in the bowed shaft frame."""
    low = np.array([-75.0, -60.0, -15.0])
    high = np.array([60.0, 60.0, bone.length + 15.0])
    size = np.ceil((high - low) / VOXEL).astype(int) + 1
    grid = pv.ImageData(dimensions=size, spacing=(VOXEL,) * 3, origin=low)
    bent = np.asarray(grid.points, "f4").T
    straight = bent.copy()
    straight[1] -= bone.bowed(bent[2]).astype("f4")

    def local(name: str) -> np.ndarray:
        turn, scale, origin = bone.frame(name)
        moved = straight - origin.astype("f4")[:, None]
        return (turn.T.astype("f4") @ moved) / scale.astype("f4")[:, None]

    field = shaft_field(bone, straight)
    upper = straight[2] > bone.shaft_top * 0.55
    lower = straight[2] < 150.0
    s, d = bone.proximal_scale, bone.condyle_depth / 64.0
    field[upper] = s * proximal_field(bone, local("proximal")[:, upper], field[upper] / s)
    field[lower] = d * distal_field(local("distal")[:, lower], field[lower] / d)
    # the head stays a true sphere: it is placed on the bowed bone, not bowed with it
    centre = head_centre(bone)
    radius = bone.head_diameter / 2
    field = join(field, ellipsoid(bent, centre, (radius,) * 3), 4.0)
    turn, _, _ = bone.frame("proximal")
    fovea = centre + turn @ FOVEA * (radius + 3.8)
    field = cut(field, ellipsoid(bent, fovea, (6.2, 6.2, 5.6)), 3.5)
    grid["field"] = field
    surface = grid.contour([0.0], scalars="field", method="flying_edges")
    surface = surface.extract_largest().clean()
    # cleaning leaves the slivers of the contour as lines: keep the faces only, and as the field
    # grows outwards they face inwards: turn them
    inside_out = pv.PolyData(surface.points, faces=surface.faces).triangulate()
    return inside_out.flip_faces().smooth_taubin(n_iter=40, pass_band=0.05)


def even_mesh(fine: pv.PolyData, n: int) -> pv.PolyData:
    """Remesh to n evenly spread vertices.

    The surface is parted into n equal patches (Lloyd's algorithm); a triangle joins three
    patches wherever they meet.
    """
    dense = fine.subdivide(1, "linear")
    points = np.asarray(dense.points, float)
    faces = dense.regular_faces
    area = dense.compute_cell_sizes()["Area"]
    weight = np.bincount(faces.ravel(), np.repeat(area, 3), len(points))
    for start in range(8):
        rng = np.random.default_rng(start)
        seeds = points[rng.choice(len(points), n, replace=False, p=weight / weight.sum())]
        for _ in range(25):
            patch = cKDTree(seeds).query(points)[1]
            moments = [np.bincount(patch, weight * c, n) for c in points.T]
            seeds = np.stack(moments, 1) / np.bincount(patch, weight, n)[:, None]
        patch = cKDTree(seeds).query(points)[1]
        corners = np.sort(patch[faces], axis=1)
        meets = np.flatnonzero((np.diff(corners, axis=1) > 0).all(axis=1))
        _, once = np.unique(corners[meets], axis=0, return_index=True)
        on_surface = fine.find_closest_cell(seeds, return_closest_point=True)[1]
        mesh = pv.PolyData.from_regular_faces(on_surface, patch[faces[meets[np.sort(once)]]])
        # now and then two patches touch in two places, which pinches the surface: start elsewhere
        if is_closed_surface(mesh):
            return mesh
    raise RuntimeError("no start gave a closed surface")


def is_closed_surface(mesh: pv.PolyData) -> bool:
    """Tell whether the faces make one closed surface without handles."""
    corners = mesh.regular_faces
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, shared = np.unique(edges, axis=0, return_counts=True)
    used = len(np.unique(corners))
    sphere = used - len(shared) + len(corners) == 2
    return bool(sphere and (shared == 2).all() and used == mesh.n_points)


@dataclass(frozen=True)
class Landmark:
    """An anatomical place, told in the same words for every femur.

    With `reach` it is the point furthest towards a direction among those near the anchor; without,
    it is where a ray from the anchor leaves the bone.
    """

    name: str
    frame: str
    anchor: tuple[float, float, float]
    towards: tuple[float, float, float]
    reach: float = 0.0
    passenger: bool = False
    note: str = ""

    def on(self, bone: Femur, fine: pv.PolyData) -> np.ndarray:
        """Find the place on the fine surface of a bone (bowed shaft frame)."""
        turn, scale, _ = bone.frame(self.frame)
        anchor = bone.to_shaft(self.frame, [self.anchor])[0]
        anchor[1] += bone.bowed(anchor[2])
        towards = turn @ np.array(self.towards) / np.linalg.norm(self.towards)
        if self.reach:
            near = np.linalg.norm(fine.points - anchor, axis=1) < self.reach * scale[1]
            return fine.points[near][np.argmax(fine.points[near] @ towards)]
        return fine.ray_trace(anchor, anchor + 100.0 * towards, first_point=True)[0]


LANDMARKS = (
    Landmark("fovea_capitis", "head", (0, 0, 0), tuple(FOVEA), note="deepest point"),
    Landmark("femoral_head_superior", "head", (0, 0, 0), (0, 0, 1)),
    Landmark("femoral_head_anterior", "head", (0, 0, 0), (0, 1, 0)),
    Landmark("femoral_neck_superior", "neck", (0, 0, 0.52), (1, 0, 0), note="narrowest part"),
    Landmark("greater_trochanter_tip", "proximal", (8, -11, 28), (0, 0, 1), 12),
    Landmark("greater_trochanter_lateral", "proximal", (5, 0, 4), (1, 0, 0)),
    Landmark("lesser_trochanter_tip", "proximal", (-14, -17, -36), (-0.6, -0.8, 0), 10),
    Landmark("midshaft_anterior", "shaft", (0, 0, 0.5), (0, 1, 0)),
    Landmark("midshaft_linea_aspera", "shaft", (1, 0, 0.5), (0, -1, 0)),
    Landmark("lateral_epicondyle", "distal", (20, -11.5, 32), (1, 0, 0)),
    Landmark("medial_epicondyle", "distal", (-20, -12.5, 33), (-1, 0, 0)),
    Landmark("lateral_condyle_posterior", "distal", (23, -38, 23), (0, -1, 0), 14),
    Landmark("medial_condyle_posterior", "distal", (-25, -38, 22), (0, -1, 0), 14),
    Landmark("medial_condyle_distal", "distal", (-23, -14, 20), (0, 0, -1)),
    Landmark("intercondylar_notch", "distal", (0, -4, 40), (0, -0.1, -1), note="roof"),
    Landmark("patellar_groove_superior", "distal", (0, 0, 42), (0, 1, 0)),
    Landmark("gluteus_medius_insertion", "proximal", (5, -2, 10), (1, -0.2, 0.3), passenger=True),
    Landmark("iliopsoas_insertion", "proximal", (-6, -7, -42), (-0.6, -0.8, 0), passenger=True),
    Landmark("vastus_lateralis_origin", "proximal", (4, 2, -14), (1, 0.6, 0), passenger=True),
    Landmark(
        "gastrocnemius_medial_origin", "distal", (-20, -15, 36), (0, -0.7, 0.7), passenger=True
    ),
)


def write_ply(mesh: pv.PolyData, path: Path) -> str:
    """Write a binary little-endian PLY without anything but the surface; return its sha256."""
    faces = np.empty(mesh.n_cells, dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"] = 3
    faces["corners"] = mesh.regular_faces
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment pinwarp sample femur, unit mm\n"
        f"element vertex {mesh.n_points}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {mesh.n_cells}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    data = header.encode() + np.asarray(mesh.points, "<f4").tobytes() + faces.tobytes()
    path.write_bytes(data)
    return hashlib.sha256(data).hexdigest()


def make(bone: Femur, path: Path) -> tuple[str, int, np.ndarray]:
    """Make one bone and write it; return its sha256, its vertex count and its landmarks."""
    fine = fine_surface(bone)
    mesh = even_mesh(fine, N_VERTICES)
    places = bone.pose(np.array([landmark.on(bone, fine) for landmark in LANDMARKS]))
    mesh.points = bone.pose(np.asarray(mesh.points, float)).astype("f4")
    _, places = mesh.find_closest_cell(places, return_closest_point=True)
    return write_ply(mesh, path), mesh.n_points, places


def main() -> None:
    """Write both bones and the session that pairs them."""
    lines = ["# pinwarp-session: 1"]
    columns = ["name", "role", "enabled"]
    places = []
    for side, name, bone in (
        ("source", "femur_generic.ply", GENERIC),
        ("destination", "femur_subject.ply", SUBJECT),
    ):
        sha256, count, found = make(bone, HERE / name)
        lines.append(f"# {side}_mesh: {name} sha256={sha256} vertices={count}")
        columns += [f"{side}_{axis}" for axis in "xyz"]
        places.append(found)
    lines += ["# warping_penalty: 0.0", "# penalty_convention: regularising", "# unit: mm"]
    lines.append(",".join([*columns, "note"]))
    for landmark, source, destination in zip(LANDMARKS, *places, strict=True):
        role = "passenger" if landmark.passenger else "pair"
        cells = [landmark.name, role, "1", *(f"{c:z.3f}" for c in source)]
        cells += [f"{c:z.3f}" for c in destination] if role == "pair" else [""] * 3
        lines.append(",".join([*cells, landmark.note]))
    text = "\n".join(lines) + "\n"
    (HERE / "femur_sample.pinwarp.csv").write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
