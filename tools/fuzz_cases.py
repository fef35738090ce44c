"""Cases of the fuzz study and of its tests: garment specs with a fabric of their own, and body scans, all with seeded faults; and what is done with one.

A case is known by its kind and seed alone. Nothing but a GarmentError may come out of `try_garment` and `try_scan`.
"""

from __future__ import annotations

import functools
import random
import struct
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
import yaml

from garmentcad.check.examine import examine
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.errors import GarmentError
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.mesh_file import MESH_ENDINGS
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.spec_file import read_spec
from garmentcad.io.yaml_file import read_yaml
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out
from tools.faults import FACTORS, nudge_numbers, with_changed_bytes, with_faults

GRID_MM = 30.0
_SQUARE = {"a": [0, 0], "b": ["hip / 2 + 40", 0], "c": ["hip / 2 + 40", "length"], "d": [0, "length"], "h": [180, 120], "k": [300, 120]}
SAMPLER: dict[str, Any] = {  # every kind of edge, mark and area that a spec knows, on two panels that make a tube
    "schema": 1, "units": "mm", "name": "sampler", "fabric": "cloth.yaml", "mannequin": "woman-88",
    "parameters": {"length": {"value": 420, "range": [300, 500], "unit": "mm"}}, "values": {"deep": "length / 4 + sqrt(400)"},
    "panels": {
        "front": {
            "points": _SQUARE, "grain": 0, "quantity": 1, "layer": 0,
            "edges": [
                {"name": "hem", "from": "a", "to": "b", "cubic": [[100, -20], [300, -20]], "role": "hem"}, {"name": "right", "from": "b", "to": "c"},
                {"name": "waist", "from": "c", "to": "d", "spline": {"through": [[260, "length - 10"]], "start_tangent": [-1, 0]}, "role": "waist"},
                {"name": "left", "from": "d", "to": "a"},
            ],
            "notches": [{"edge": "right", "at": {"mm": "deep", "from": "c"}, "name": "n"}, {"edge": "left", "at": 0.4, "name": "m"}],
            "darts": [{"name": "dart", "edge": "waist", "at": 0.7, "intake": 20, "length": 90}],
            "internal_lines": {"crease": [[240, 40], [240, 300]], "p": [[60, 20], [60, 380]], "q": [[130, 20], [130, 380]]},
            "folds": [{"name": "crease", "line": "crease", "angle": -170}], "pleats": [{"name": "knife", "fold": "p", "under": "q", "pressed": 0.5}],
            "drill_holes": {"pocket": [100, 100]},
            "cutouts": [[{"name": "o", "from": "h", "to": "k", "arc": {"radius": 70, "bulge": "left"}}, {"name": "u", "from": "k", "to": "h"}]],
            "regions": [{"name": "yoke", "polygon": [[0, 300], [200, 300], [200, 400]], "factors": {"B": 2, "EMT": 0.5}},
                        {"name": "edge", "band": {"edge": "hem", "width": 40}, "interfacing": "hair-canvas"}],
            "placement": {"wrap": {"part": "torso", "anchor": ["hip / 4 + 20", "length"], "angle": 0, "height": "waist_height", "offset": 60}},
        },
        "back": {"mirrored_from": "front", "placement": {"transform": {"translation": [0, 600, -300], "rotation": [0, 180, 0]}}},
    },
    "seams": [
        {"name": "one", "a": ["front.right.c", "front.right.b"], "b": ["back.right.c", "back.right.b"], "ease": 0, "fold_angle": 10, "strength": 900},
        {"name": "two", "a": ["front.left.d", "front.left.a"], "b": [["back.left.d", "back.left.a"]], "bend_factor": 3},
    ],
}  # fmt: skip
_ODD = [
    None, True, False, 0, 1, -1, 0.5, -1e9, 1e300, 10**25, "", "x", "front", "hem", "waist", "wool-suiting", "../x.yaml", "cloth.yaml", "1 / 0", "waist ** 16",
    "sqrt(-1)", "9 ** 9 ** 9", "rad(", "(" * 60, "\U0001f600", [], {}, [[]], [0, 1], [[0, 0], [0, 0]], {"edge": "hem", "width": 1e4}, {"value": -1},
]  # fmt: skip
_NAMES = ("name", "edges", "points", "from", "to", "arc", "radius", "regions", "mirror", "wrap", "B", "EMT", "value", "source")
_TEXT = [
    b"{", b"}", b"[", b"- ", b'"', b",", b":", b"\n", b"  ", b"\t", b".nan", b"1e999", b"&a ", b"*a", b"!!set ", b"---\n", b"#", b"\\", b"\x00", b"\xff",
    b"[" * 40, b"9" * 5000,
]  # fmt: skip
_MESH_TEXT = [
    b"nan", b"-1", b"1e999", b"99999999999", b"f 1 2 3\n", b"f 1/2/3 -1 0\n", b"v 0 0\n", b"element vertex 4000000000\n", b"\x00", b"\xff\xff\xff\x7f", b"{}",
]  # fmt: skip
_BOXES_MM = (  # a standing figure: x, y, z from and to
    ((-160, 800, -120), (160, 1400, 120)), ((-80, 1400, -80), (80, 1480, 80)), ((-80, 1480, -120), (80, 1720, 80)),
    ((160, 1280, -40), (680, 1400, 40)), ((-680, 1280, -40), (-160, 1400, 40)), ((40, 0, -80), (160, 800, 80)), ((-160, 0, -80), (-40, 800, 80)),
)  # fmt: skip
_VOXEL_MM = 40


def write_garment(seed: int, folder: Path) -> Path:
    """A garment spec and the fabric `cloth.yaml` beside it, both with faults."""
    chance = random.Random(seed)
    names = shipped_names("patterns")
    name = chance.choice(["sampler", "sampler", *names])
    garment = deepcopy(SAMPLER if name == "sampler" else _shipped("patterns", name))
    garment["fabric"] = "cloth.yaml"
    fabric = deepcopy(_shipped("fabrics", chance.choice(shipped_names("fabrics"))))
    for data, path in ((garment, folder / "garment.yaml"), (fabric, folder / "cloth.yaml")):
        kind = chance.random() if data is garment or chance.random() < 0.4 else 1.0
        if kind < 0.5:
            nudge_numbers(data, chance, (*FACTORS, 1.05, 0.95, 1e-6, 1e5))
        raw = _yaml(with_faults(data, chance, _ODD, _NAMES) if 0.3 < kind < 0.9 else data)
        path.write_bytes(with_changed_bytes(raw, chance, _TEXT) if 0.8 < kind < 1.0 else raw)
    return folder / "garment.yaml"


def try_garment(path: Path) -> str:
    """Read, draft, check, lay out, place and weld; nothing is draped. What came of it in a word."""
    try:
        spec = read_spec(path)
    except GarmentError as fault:
        return type(fault).__name__
    errors = sum(finding.severity == "error" for finding in examine(spec, grid_mm=GRID_MM))
    try:
        job = make_job(spec, grid_mm=GRID_MM)
        materials, material_of = lay_out(job)
        cloth = build_cloth(job.pattern, material_of, materials, job.grid_mm)
        place_vertices(job.pattern, cloth, job.mannequin)
        weld(cloth)
    except GarmentError as fault:
        return type(fault).__name__ if errors else f"{type(fault).__name__} that the doctor does not tell"
    return "laid out, with errors of the doctor" if errors else "laid out"


def write_scan(seed: int, folder: Path) -> Path:
    """A body scan in one of the formats: a box figure whose arrays, and then whose bytes, have faults."""
    chance = random.Random(seed)
    vertices, faces = (array.copy() for array in box_figure())
    for _ in range(chance.randint(0, 2)):
        vertices, faces = _with_broken_arrays(vertices, faces, chance)
    ending = chance.choice(MESH_ENDINGS)
    raw = trimesh.Trimesh(vertices, faces, process=False).export(
        file_type=ending[1:], **({"encoding": "ascii"} if chance.random() < 0.3 and ending == ".ply" else {})
    )
    raw = raw.encode() if isinstance(raw, str) else raw
    path = folder / f"scan-{seed}{ending}"  # a name of its own: mannequins are read once
    path.write_bytes(_with_broken_bytes(raw, chance))
    return path


def try_scan(path: Path) -> str:
    """Read it as a mannequin. What came of it in a word."""
    try:
        body = read_mannequin(path)
    except GarmentError as fault:
        return type(fault).__name__
    if not np.isfinite([*body.measurements_mm.values()]).all() or not np.isfinite(body.vertices).all():
        raise AssertionError("a mannequin with numbers that are not finite")
    return "a mannequin"


@functools.lru_cache(maxsize=1)
def box_figure() -> tuple[np.ndarray, np.ndarray]:
    """A standing figure of boxes with its arms held out: vertices (V,3) m, faces (F,3), closed, turned outward."""
    low = np.array([box[0] for box in _BOXES_MM]).min(axis=0) - _VOXEL_MM
    high = np.array([box[1] for box in _BOXES_MM]).max(axis=0) + _VOXEL_MM
    filled = np.zeros((high - low) // _VOXEL_MM, dtype=bool)
    for start, end in _BOXES_MM:
        a, b = (np.array(start) - low) // _VOXEL_MM, (np.array(end) - low) // _VOXEL_MM
        filled[a[0] : b[0], a[1] : b[1], a[2] : b[2]] = True
    quads = []
    for axis in range(3):
        step = np.eye(3, dtype=int)
        u, v = step[(axis + 1) % 3], step[(axis + 2) % 3]
        for way in (1, -1):
            bare = np.argwhere(filled & ~np.roll(filled, -way, axis=axis))
            corner = bare + (step[axis] if way == 1 else 0)
            ring = [corner, corner + u, corner + u + v, corner + v]
            quads.append(np.stack(ring if way == 1 else ring[::-1], axis=1))
    corners = np.concatenate(quads)
    places, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    rings = index.reshape(-1, 4)
    return (places * _VOXEL_MM + low) * 1e-3, np.concatenate([rings[:, [0, 1, 2]], rings[:, [0, 2, 3]]])


def _with_broken_arrays(vertices: np.ndarray, faces: np.ndarray, chance: random.Random) -> tuple[np.ndarray, np.ndarray]:
    some = np.array([chance.random() < 0.02 for _ in range(len(vertices))])
    kind = chance.randrange(12)
    if kind == 0:
        vertices = vertices * chance.choice([1e-3, 10.0, 39.37, 100.0, 1000.0, 1e30, 0.0])
    elif kind == 1:
        vertices = vertices * [chance.choice([-1.0, 0.0, 0.3, 2.0]) for _ in range(3)]
    elif kind == 2:
        vertices = vertices[:, [chance.randrange(3) for _ in range(3)]]
    elif kind == 3:
        vertices[some] = chance.choice([np.nan, np.inf, 1e300, -1e18, 0.0])
    elif kind == 4:
        vertices[some] += [[chance.gauss(0.0, 0.05) for _ in range(3)] for _ in range(int(some.sum()))]
    elif kind == 5:
        faces = faces[: chance.randrange(len(faces) + 1)]
    elif kind == 6:
        faces = np.concatenate([faces, faces[: chance.randrange(len(faces))]])
    elif kind == 7:
        faces[: chance.randrange(len(faces) + 1)] = faces[: chance.randrange(len(faces) + 1), ::-1][:1]
    elif kind == 8:
        faces = faces[:, ::-1]
    elif kind == 9:
        level = chance.uniform(0.0, 1.8)
        vertices[:, 1] = np.minimum(vertices[:, 1], level) if chance.random() < 0.5 else np.maximum(vertices[:, 1], level)
    elif kind == 10:
        moved = vertices + np.array([chance.choice([0.0, 0.3, 3.0]), 0.0, 0.0])
        vertices, faces = np.concatenate([vertices, moved]), np.concatenate([faces, faces + len(vertices)])
    else:
        turn, at = np.eye(3), chance.uniform(-3.2, 3.2)
        turn[:2, :2] = [[np.cos(at), -np.sin(at)], [np.sin(at), np.cos(at)]]
        vertices = vertices @ turn.T
    return vertices, faces


def _with_broken_bytes(raw: bytes, chance: random.Random) -> bytes:
    """In half of the files: cut off, bytes of the head or of anywhere overwritten, or pieces put in."""
    kind = chance.randrange(8)
    if kind > 3 or not raw:
        return raw
    if kind == 0:
        return raw[: chance.randrange(len(raw))]
    if kind == 1:
        return with_changed_bytes(raw, random.Random(chance.random()), _MESH_TEXT)
    end = len(raw) if kind == 2 else min(len(raw), 300)
    broken = bytearray(raw)
    for _ in range(chance.randint(1, 8)):
        where = chance.randrange(end)
        piece = chance.choice(
            [bytes([chance.randrange(256)]), struct.pack("<I", chance.choice([0, 1, 2**31 - 1, 2**32 - 1, 10**6])), struct.pack("<f", float("nan"))]
        )
        broken[where : where + len(piece)] = piece
    return bytes(broken)


@functools.cache
def _shipped(kind: Any, name: str) -> Any:
    return read_yaml(shipped_file(kind, name))


def _yaml(data: Any) -> bytes:
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True).encode("utf-8", "surrogatepass")


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    def ignore_aliases(self, data: Any) -> bool:
        return True
