"""The door for body scans: OBJ, PLY, STL and GLB files through trimesh; every failure becomes a MeshError or FileError."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from garmentcad.arrays import floats, frozen, indices
from garmentcad.errors import MeshError
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.geometry.repair import repaired
from garmentcad.io.yaml_file import read_bytes
from garmentcad.mannequin.mannequin import MAX_STATURE_M, MIN_STATURE_M

MESH_ENDINGS = (".obj", ".ply", ".stl", ".glb")
MAX_BYTES = 200_000_000
MAX_FACES = 500_000
MIN_FACES = 100
LEAST_GROWN_M = 1.0  # a scan in inches that is read in cm stands lower
UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "inch": 0.0254, "mm": 0.001}
_STL_HEAD, _STL_FACET = 84, 50  # bytes
_HOW_UNIT = "name the scan and `unit: {}` in a file that stands beside it"


def read_mesh(path: str | Path, unit: str | None = None) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """The one closed surface in a mesh file: vertices (V,3) float64 in m and faces (F,3) int32, counter-clockwise from outside; y is up. And what was repaired.

    unit: one of UNITS; None takes the one (m, cm or mm) that makes the height that of a body (0.5 to 2.5 m), and says so
    where inches are as likely. Vertices at the same place are joined; small holes, stray pieces and turned faces are repaired (geometry/repair.py).
    MeshError when the file holds no mesh, lies about its size, has values that are not finite, more than MAX_FACES faces, is not closed, holds several
    pieces, or is no body by its height; where the repaired surface crosses itself. FileError when it cannot be read.
    """
    file = str(path)
    ending = Path(path).suffix.lower()
    if ending not in MESH_ENDINGS:
        raise MeshError(f"the ending {ending!r} is not that of a mesh; allowed: {', '.join(MESH_ENDINGS)}", file=file)
    if unit is not None and unit not in UNITS:
        raise MeshError(f"the unit {unit!r} is not known; allowed: {', '.join(UNITS)}", file=file)
    raw = read_bytes(path, MAX_BYTES)
    _check_claims(raw, ending, file)
    vertices, faces = _load(raw, ending, file)
    _check_arrays(vertices, faces, file)
    vertices, faces = _joined(vertices, faces)
    if len(faces) < MIN_FACES:
        raise MeshError(f"{len(faces)} faces are left when vertices at the same place are joined; a body has at least {MIN_FACES}", file=file)
    vertices, faces, notes = repaired(vertices, faces)
    _check_surface(vertices, faces, file)
    if notes and len(crossings := crossing_triangle_pairs(floats(vertices), indices(faces))):
        raise MeshError(f"repaired ({'; '.join(notes)}), the surface crosses itself in {len(crossings)} pairs of faces; repair the scan", file=file)
    height = float(np.ptp(vertices[:, 1]))
    scale = UNITS[unit] if unit is not None else _unit_for(np.ptp(vertices, axis=0), file)
    if unit is None and scale * height < LEAST_GROWN_M <= UNITS["inch"] * height <= MAX_STATURE_M:
        notes = (*notes, f"{height:.4g} was read as {1000.0 * scale * height:.0f} mm of height; where the numbers are inches, {_HOW_UNIT.format('inch')}")
    if not MIN_STATURE_M <= scale * height <= MAX_STATURE_M:
        raise MeshError(f"the height along y is {scale * height:.4g} m; allowed: {MIN_STATURE_M:g} to {MAX_STATURE_M:g} m (y is up)", file=file)
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    if (np.cross(a, b) * c).sum() < 0.0:  # six times the volume: the faces look inward
        faces = faces[:, ::-1]
    return frozen(floats(scale * vertices)), frozen(indices(faces)), notes


def _check_claims(raw: bytes, ending: str, file: str) -> None:
    """Sizes that a file claims are compared with its length before anything is allocated."""
    if not raw:
        raise MeshError("the file is empty", file=file)
    if ending == ".stl" and not raw[:512].lstrip().startswith(b"solid"):
        if len(raw) < _STL_HEAD:
            raise MeshError(f"{len(raw)} bytes are too few for a binary STL file", file=file)
        claimed = struct.unpack_from("<I", raw, 80)[0]
        if _STL_HEAD + claimed * _STL_FACET != len(raw):
            real = (len(raw) - _STL_HEAD) / _STL_FACET
            raise MeshError(f"the STL header claims {claimed} triangles, the file's length fits {real:g}", file=file)
    if ending == ".ply":
        head = raw[:4096].split(b"end_header")[0]
        for line in head.splitlines():
            words = line.split()
            if len(words) == 3 and words[0] == b"element" and (not words[2].isdigit() or int(words[2]) > len(raw)):
                count, what = (word[:20].decode("latin-1") for word in (words[2], words[1]))
                raise MeshError(f"the PLY header claims {count} of {what}, more than the file holds", file=file)
    if ending == ".glb":
        _check_accessors(raw, file)


def _check_accessors(raw: bytes, file: str) -> None:
    """An accessor of a GLB file needs no bytes of its own: one without a view stands for as many zeros as it says, several may look at one view, and a mesh
    may stand in many places."""
    try:
        size, kind = struct.unpack_from("<I4s", raw, 12)
        head = json.loads(raw[20 : 20 + size]) if kind == b"JSON" else {}
        claims = [(accessor["count"], "bufferView" in accessor) for accessor in head.get("accessors", [])]
        places = sum("mesh" in node for node in head.get("nodes", []))
        meshes = len(head.get("meshes", []))
        most = sum(count for count, _ in claims)
        unseen = [count for count, seen in claims if not seen]
    except (struct.error, ValueError, KeyError, TypeError, AttributeError, RecursionError) as fault:
        raise MeshError(f"not a readable GLB mesh ({type(fault).__name__}: {str(fault)[:200]})", file=file) from None
    if unseen:
        raise MeshError(f"an accessor of {unseen[0]} elements has no bufferView; all arrays of a scan must be in its file", file=file)
    if places > meshes:
        raise MeshError(f"{meshes} meshes stand in {places} places; each may stand in one", file=file)
    if most > len(raw):
        raise MeshError(f"the GLB accessors claim {most} elements, more than the file holds", file=file)


def _load(raw: bytes, ending: str, file: str) -> tuple[np.ndarray, np.ndarray]:
    import trimesh  # takes a while, and bodies that are no scans do without it

    if ending == ".obj":
        # Numbers are the same in all encodings, and trimesh asks for one more package where a name is not in UTF-8.
        raw = raw.decode("utf-8", errors="replace").encode()
    try:
        with np.errstate(invalid="ignore"):  # values that are not finite are refused below, by name
            scene = trimesh.load_scene(io.BytesIO(raw), file_type=ending[1:], process=False, skip_materials=True)
        meshes = [piece for piece in scene.dump() if isinstance(piece, trimesh.Trimesh)]
        if not meshes:
            raise MeshError("the file holds no triangles", file=file)
        counts = np.cumsum([0, *(len(piece.vertices) for piece in meshes)])
        vertices = np.vstack([np.asarray(piece.vertices, dtype=np.float64) for piece in meshes])
        faces = np.vstack([np.asarray(piece.faces, dtype=np.int64).reshape(-1, 3) + start for piece, start in zip(meshes, counts)])
    except MeshError:
        raise
    except (MemoryError, RecursionError):
        raise MeshError("the file needs more memory than it is worth", file=file) from None
    except Exception as fault:  # trimesh raises whatever its parsers raise
        raise MeshError(f"not a readable {ending[1:].upper()} mesh ({type(fault).__name__}: {str(fault)[:200]})", file=file) from None
    return vertices, faces


def _check_arrays(vertices: np.ndarray, faces: np.ndarray, file: str) -> None:
    if len(faces) > MAX_FACES:
        raise MeshError(f"{len(faces)} faces; at most {MAX_FACES} are allowed: simplify the scan", file=file)
    if len(faces) < MIN_FACES:
        raise MeshError(f"{len(faces)} faces; a body has at least {MIN_FACES}", file=file)
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"a face names vertex {faces.max() if faces.max() >= len(vertices) else faces.min()}; there are {len(vertices)}", file=file)
    bad = np.flatnonzero(~np.isfinite(vertices).all(1))
    if len(bad):
        raise MeshError(f"vertex {bad[0]} is not finite ({len(bad)} such vertices)", file=file)


def _joined(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices at exactly the same place become one (STL and UV seams split them); unused ones and faces without area by index go."""
    _, first, inverse = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")  # keeps the file's order
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    faces = rank[inverse.ravel()][faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    used, packed = np.unique(faces, return_inverse=True)
    return vertices[first[order]][used], packed.reshape(-1, 3)


def _check_surface(vertices: np.ndarray, faces: np.ndarray, file: str) -> None:
    half = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, counts = np.unique(np.sort(half, axis=1), axis=0, return_counts=True)
    open_edges, crowded = int((counts == 1).sum()), int((counts > 2).sum())
    if open_edges:
        raise MeshError(f"the surface is not closed: {open_edges} edges have a face on one side only; close the holes of the scan", file=file)
    if crowded:
        raise MeshError(f"the surface is not a solid's: {crowded} edges have more than two faces", file=file)
    if len(np.unique(half, axis=0)) != len(half):
        raise MeshError("the faces are not turned alike: two neighbours run along their edge in the same direction", file=file)
    joined = coo_array((np.ones(len(half), dtype=bool), (half[:, 0], half[:, 1])), shape=(len(vertices), len(vertices)))
    pieces = connected_components(joined, directed=False, return_labels=False)
    if pieces != 1:
        raise MeshError(f"{pieces} separate surfaces; one closed body is wanted", file=file)


def _unit_for(extents: np.ndarray, file: str) -> float:
    height = extents[1]
    if (scale := _unit_of(height)) is not None:
        return scale
    # Other programs have z up. Which way to turn the scan would be a guess.
    longest = int(np.argmax(extents))
    if longest != 1 and _unit_of(extents[longest]) is not None:
        remedy = f"along {'xyz'[longest]} it is as long as a body: turn the scan upright"
    else:
        remedy = f"{_HOW_UNIT.format('inch')} (allowed: {', '.join(UNITS)})"
    raise MeshError(
        f"the height along y is {height:.4g}: in m, cm and mm alike outside {MIN_STATURE_M:g} to {MAX_STATURE_M:g} m (y is up); {remedy}", file=file
    )


def _unit_of(length: float) -> float | None:
    """The one of m, cm and mm that makes a length the height of a body."""
    return next((UNITS[name] for name in ("m", "cm", "mm") if MIN_STATURE_M <= UNITS[name] * length <= MAX_STATURE_M), None)
