"""Wavefront OBJ of a draped garment and of its mannequin, in metres with 9 significant digits (a nanometre on a garment)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import FileError, MeshError
from garmentcad.io.atomic import write_atomic
from garmentcad.io.mesh_file import MAX_BYTES
from garmentcad.io.yaml_file import read_bytes
from garmentcad.mannequin.mannequin import Mannequin

FARTHEST_M = 1e6  # at the speed at which a run counts as diverged nothing gets there in the longest drape


def write_garment_obj(path: str | Path, cloth: Cloth, positions: np.ndarray) -> Path:
    """Write the triangles that contact uses.

    positions: (P,3) m. `v` are the particles (sewn panels share theirs), `vt` the panel millimetres of every cloth vertex, one group `g PANEL` a panel.
    Faces keep the pattern's orientation: normals point to the right side of the fabric.
    """
    corners = cloth.particle_triangles + 1
    uv = cloth.triangles + 1
    panel = cloth.vertex_panel[cloth.triangles[:, 0]]
    lines = ["# garmentcad: metres, y up; vt = panel millimetres"]
    lines += [_rows("v %.9g %.9g %.9g", positions), _rows("vt %.9g %.9g", cloth.vertex_uv_mm)]
    for index, name in enumerate(cloth.panel_names):
        lines.append(f"g {_group_name(name)}")
        lines.append(_rows("f %d/%d %d/%d %d/%d", np.stack([corners[panel == index], uv[panel == index]], axis=2)))
    return write_atomic(path, "\n".join(lines) + "\n")


def write_mannequin_obj(path: str | Path, mannequin: Mannequin) -> Path:
    """Write the body's surface, one group a body part."""
    faces = mannequin.faces + 1
    lines = ["# garmentcad: metres, y up", _rows("v %.9g %.9g %.9g", mannequin.vertices)]
    for index, name in enumerate(mannequin.part_names):
        lines.append(f"g {_group_name(name)}")
        lines.append(_rows("f %d %d %d", faces[mannequin.face_part == index]))
    return write_atomic(path, "\n".join(lines) + "\n")


def _rows(pattern: str, rows: np.ndarray) -> str:
    """A line for each row, formatted in one go."""
    return "\n".join([pattern] * len(rows)) % tuple(rows.ravel().tolist())


def _group_name(name: str) -> str:
    """OBJ separates words of a group line by blanks: one panel must stay one word."""
    return "_".join(name.split())


def read_garment_obj(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Positions (P,3) m and triangles (F,3) that `write_garment_obj` wrote, of whatever version. Raises MeshError for anything else."""
    points, corners, _, _ = _read(path, "garment")
    return points, corners


def read_mannequin_obj(path: str | Path) -> Mannequin:
    """The surface and parts that `write_mannequin_obj` wrote (no measurements, landmarks or cylinders). Raises MeshError for anything else."""
    points, corners, parts, part = _read(path, "mannequin")
    if part.min() < 0:
        raise MeshError("is not a mannequin written by garmentcad (faces before the first group)", file=str(path))
    return Mannequin(Path(path).stem, points, corners, {}, {}, {}, parts, part)


def _read(path: str | Path, what: str) -> tuple[np.ndarray, np.ndarray, tuple[str, ...], np.ndarray]:
    """Points (P,3) m, triangles (F,3), names of the groups, group of each triangle (F,) int32, -1 before the first. MeshError for what is no `what`."""
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    groups: list[str] = []
    group: list[int] = []
    try:
        for line in read_bytes(path, MAX_BYTES).decode("utf-8").splitlines():
            keyword, *words = line.split() or ["#"]
            if keyword == "v":
                vertices.append([float(word) for word in words])
            elif keyword == "g":
                groups.append(words[0])
            elif keyword == "f":
                faces.append([int(word.partition("/")[0]) - 1 for word in words])
                group.append(len(groups) - 1)
        if {*map(len, vertices)} | {*map(len, faces)} != {3}:
            raise ValueError("points of three numbers and triangles are wanted")
        points, corners = floats(vertices), indices(faces)
        if not ((np.abs(points) < FARTHEST_M).all() and corners.min() >= 0 and corners.max() < len(points)):
            raise ValueError("faces and vertices do not fit together")
    except FileError as fault:
        raise MeshError(fault.message, file=str(path)) from None
    except (ValueError, IndexError, OverflowError) as error:
        raise MeshError(f"is not a {what} written by garmentcad ({error})", file=str(path)) from error
    return points, corners, tuple(groups), indices(group)
