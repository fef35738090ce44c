"""A dress form: a body without head and arms, closed by flat caps at neck and armscyes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.arrays import floats, frozen, indices
from garmentcad.geometry.portable import norm, product
from garmentcad.geometry.triangulate import constrained_triangles
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.smooth import averaging

_NECK = 0.045  # m of the neck that stays above its base
_SPACING = 0.014  # m between the points of a cap
_RELAXED = 0.025  # m from the cut within which the surface is evened out
_BEHIND = 0.15
_ROUNDS = 12
_TAKEN_OFF = ("elbow", "wrist")  # landmarks
NOT_MEASURED = ("stature", "top_arm", "wrist", "arm_length")  # as on the whole body


def dress_form(body: Mannequin) -> Mannequin:
    """The form of a body; it has no rig. Measurements of what is taken off stay those of the body and are named in `estimated`."""
    vertices, part = body.vertices.copy(), body.face_part
    marks = body.landmarks
    up = np.cross(marks["neck_front"] - marks["nape"], [1.0, 0.0, 0.0])
    up = up / norm(up) * np.sign(up[1])
    high = product(vertices[body.faces].mean(axis=1) - marks["nape"], up) > _NECK
    head, torso = body.part_names.index("head"), body.part_names.index("torso")
    openings = [((part == head) & high, head), *((part == body.part_names.index(f"arm_{side}"), torso) for side in ("left", "right"))]
    openings = [(_without_ears(body.faces, cut), owner) for cut, owner in openings]
    kept = ~np.any([cut for cut, _ in openings], axis=0)
    rims = [_loop(body.faces[kept], body.faces[cut]) for cut, _ in openings]
    for rim in rims:
        vertices[rim] = _flat(vertices[rim])
    vertices = _evened(vertices, body.faces[kept], rims)
    points, faces, parts = [vertices], [body.faces[kept]], [part[kept]]
    for rim, (_, owner) in zip(rims, openings):
        inner, cap = _cap(vertices[rim])
        count = sum(len(rows) for rows in points)
        faces.append(np.r_[rim, count + np.arange(len(inner))][cap])
        points.append(inner)
        parts.append(np.full(len(cap), owner))
    used, packed = np.unique(np.vstack(faces), return_inverse=True)
    surface = np.vstack(points)[used]
    edge = vertices[np.concatenate(rims[1:])]
    left = {name: point for name, point in marks.items() if not name.startswith(_TAKEN_OFF)}
    for name in ("shoulder_point_left", "shoulder_point_right", "armpit_left", "armpit_right"):
        left[name] = edge[np.linalg.norm(edge - marks[name], axis=1).argmin()]
    return replace(
        body,
        vertices=frozen(floats(surface)),
        faces=frozen(indices(packed.reshape(-1, 3))),
        face_part=frozen(indices(np.concatenate(parts))),
        landmarks=left,
        rig=None,
        estimated=(*body.estimated, *NOT_MEASURED),
    )


def _without_ears(faces: np.ndarray, cut: np.ndarray) -> np.ndarray:
    """The cut (F,) with those faces, too, that would stay with all corners on its rim: they would lie flat on the cap."""
    while True:
        rim = np.intersect1d(faces[cut], faces[~cut])
        ears = ~cut & np.isin(faces, rim).all(axis=1)
        if not ears.any():
            return cut
        cut = cut | ears


def _loop(kept: np.ndarray, cut: np.ndarray) -> np.ndarray:
    """Vertices (L,) around a cut, in the order of the border's half edges of the faces that stay."""
    gone = {(a, b) for face in cut.tolist() for a, b in zip(face, face[1:] + face[:1])}
    after = {a: b for face in kept.tolist() for a, b in zip(face, face[1:] + face[:1]) if (b, a) in gone}
    loop = [min(after)]
    while len(loop) < len(after):
        loop.append(after[loop[-1]])
    return np.array(loop)


def _flat(rim: np.ndarray) -> np.ndarray:
    """The rim (L,3) in its mean plane, without its teeth."""
    for _ in range(_ROUNDS):
        rim = 0.5 * rim + 0.25 * (np.roll(rim, 1, axis=0) + np.roll(rim, -1, axis=0))
    middle, normal = _plane(rim)
    return rim - product(rim - middle, normal)[:, None] * normal


def _plane(rim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and unit area vector of a loop; of a rim it points into the body, whose faces lie to the left of it."""
    middle = rim.mean(axis=0)
    normal = np.cross(rim - middle, np.roll(rim, -1, axis=0) - middle).sum(axis=0)
    return middle, normal / norm(normal)


def _evened(vertices: np.ndarray, faces: np.ndarray, rims: list[np.ndarray]) -> np.ndarray:
    """The surface near the rims averaged over neighbours, and held behind the planes of the cuts: _BEHIND m for each m from the rim."""
    used, packed = np.unique(faces, return_inverse=True)
    average, points = averaging(packed.reshape(-1, 3), len(used)), vertices[used]
    fixed = np.isin(used, np.concatenate(rims))
    near = []
    for rim in rims:
        distance = cKDTree(vertices[rim]).query(points)[0]
        near.append((np.flatnonzero((distance < _RELAXED) & ~fixed), distance, *_plane(vertices[rim])))
    free = np.zeros(len(used), dtype=bool)
    free[np.concatenate([rows for rows, *_ in near])] = True
    for _ in range(_ROUNDS):
        points = np.where(free[:, None], 0.5 * (points + average @ points), points)
        for rows, distance, middle, inward in near:
            short = np.maximum(_BEHIND * distance[rows] - product(points[rows] - middle, inward), 0.0)
            points[rows] += short[:, None] * inward
    moved = vertices.copy()
    moved[used] = points
    return moved


def _cap(rim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner points (I,3) and triangles (T,3) over the rim's and the inner points of the flat cap that closes it."""
    middle, normal = _plane(rim)
    first = np.cross(normal, [0.0, 0.0, 1.0])
    first /= norm(first)
    axes = np.stack([first, np.cross(normal, first)])
    border = product(rim - middle, axes.T)
    steps = np.arange(-20, 21)
    across, along = np.meshgrid(steps, steps)
    lattice = _SPACING * np.column_stack([(across + 0.5 * (along % 2)).ravel(), 0.866 * along.ravel()])
    ends = np.roll(border, -1, axis=0)
    straight, way = ends - border, lattice[:, None] - border[None]
    inside = ((straight[None, :, 0] * way[..., 1] - straight[None, :, 1] * way[..., 0]) / np.linalg.norm(straight, axis=1) > 0.6 * _SPACING).all(axis=1)
    flat = np.vstack([border, lattice[inside]])
    count = len(border)
    # Seen from outside the cap turns against the rim of what stays.
    triangles = constrained_triangles(flat, np.column_stack([np.arange(count), np.roll(np.arange(count), -1)]))
    return middle + product(lattice[inside], axes), triangles[:, ::-1]
