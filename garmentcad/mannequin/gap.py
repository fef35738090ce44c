"""How near the parts of a body come to each other, away from their common joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.arrays import entry, floats, frozen, indices, kernel
from garmentcad.errors import MannequinError
from garmentcad.geometry.closest import point_triangle, row
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import M_TO_MM

APART = 0.008  # m, least distance between parts
JOINT = 0.060  # m, around their joint parts may be nearer
_FAR = 0.012  # m; what is farther is not looked at closely


class Facing(NamedTuple):
    """Two parts that must stay apart: faces of each that are not near their joint."""

    name: str
    one: np.ndarray  # (A,3)
    other: np.ndarray  # (B,3)


def facings(body: Mannequin) -> list[Facing]:
    """The pairs of parts of a body in its own pose. Thigh and lower leg count as two."""
    part = {name: body.faces[body.face_part == body.part_names.index(name)] for name in body.part_names}
    found = []
    for side in ("left", "right"):
        arm, leg = part[f"arm_{side}"], part[f"leg_{side}"]
        knee = body.landmarks[f"knee_{side}"][1]
        height = body.vertices[leg].mean(axis=1)[:, 1]
        found.append(_facing(body, f"leg_{side} and torso", leg, part["torso"]))
        if len(arm):  # not on a dress form
            found.append(_facing(body, f"arm_{side} and torso", arm, part["torso"]))
            found.append(Facing(f"arm_{side} and legs", arm, np.vstack([part["leg_left"], part["leg_right"]])))
        found.append(Facing(f"thigh and lower leg on the {side}", leg[height > knee + JOINT], leg[height < knee - JOINT]))
    crotch = body.landmarks["crotch"][1] - JOINT
    low = [faces[body.vertices[faces][..., 1].max(axis=1) < crotch] for faces in (part["leg_left"], part["leg_right"])]
    return [*found, Facing("leg_left and leg_right", *low)]


def _facing(body: Mannequin, name: str, one: np.ndarray, other: np.ndarray) -> Facing:
    rim = cKDTree(body.vertices[np.intersect1d(one, other)])
    near = rim.query(body.vertices)[0] <= JOINT
    return Facing(name, one[~near[one].any(axis=1)], other[~near[other].any(axis=1)])


def check_apart(pairs: list[Facing], vertices: np.ndarray, key: str) -> None:
    """MannequinError that names the parts which come nearer than APART on vertices (V,3); key: what the user may change."""
    for pair in pairs:
        distance = min(_distance(vertices, pair.one, pair.other), _distance(vertices, pair.other, pair.one))
        if distance < APART:
            raise MannequinError(f"{pair.name} come within {distance * M_TO_MM:.1f} mm of each other; at least {APART * M_TO_MM:g} mm are wanted", key=key)


def check_uncrossed(body: Mannequin, vertices: np.ndarray, key: str) -> None:
    """MannequinError that names the parts which cross in the folds of a joint."""
    crossing = crossing_triangle_pairs(vertices, body.faces)
    if len(crossing):
        names = sorted({body.part_names[part] for part in body.face_part[crossing[0]]})
        where = np.round(vertices[body.faces[crossing[0, 0]]].mean(axis=0), 2).tolist()
        raise MannequinError(f"the body crosses itself ({' and '.join(names)} at {where} m)", key=key)


def _distance(vertices: np.ndarray, one: np.ndarray, other: np.ndarray) -> float:
    """Least distance of the corners of faces `one` from the faces `other`, or _FAR."""
    if len(one) == 0 or len(other) == 0:
        return _FAR
    corners, targets = np.unique(one), np.unique(other)
    longest = np.sqrt(((vertices[other] - vertices[np.roll(other, 1, axis=1)]) ** 2).sum(axis=2).max())
    reach = _FAR + longest / np.sqrt(3.0)  # no point of a triangle is farther than that from the next corner
    away = cKDTree(vertices[targets]).query(vertices[corners], distance_upper_bound=reach)[0]
    near = corners[np.isfinite(away)]
    if len(near) == 0:
        return _FAR
    close = np.zeros(len(vertices), dtype=bool)
    close[targets] = np.isfinite(cKDTree(vertices[near]).query(vertices[targets], distance_upper_bound=reach)[0])
    faces = other[close[other].any(axis=1)]
    out = np.empty(len(near))
    _distances(frozen(floats(vertices)[:]), indices(near), indices(faces), out)  # of a body that moves, too: else the kernel is compiled twice
    return float(min(out.min(), _FAR))


@entry
@kernel
def _distances(vertices, rows, faces, out):  # type: ignore[no-untyped-def]
    """Distance of each of the vertices `rows` from the nearest of the faces."""
    for k in range(len(rows)):
        point = row(vertices, rows[k])
        least = 1e30
        for face in range(len(faces)):
            squared = point_triangle(point, row(vertices, faces[face, 0]), row(vertices, faces[face, 1]), row(vertices, faces[face, 2]))[3]
            least = min(least, squared)
        out[k] = np.sqrt(least)
