"""Binary glTF (GLB) of a draped garment on its mannequin: one mesh a panel with its own material, texture coordinates in metres on the pattern."""

from __future__ import annotations

import colorsys
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad import __version__
from garmentcad.cloth.cloth import Cloth
from garmentcad.export.normals import particle_normals, split_at_creases
from garmentcad.io.atomic import write_atomic
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import MM_TO_M

BODY_COLOR = (0.62, 0.62, 0.64)
# Numbers of the glTF 2.0 specification.
_FLOAT, _UNSIGNED = 5126, 5125
_VERTICES, _CORNERS = 34962, 34963
_KIND = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}


def write_garment_glb(path: str | Path, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin | None = None) -> Path:
    """Write a scene with a node `panel_NAME` for each panel and, where given, a node `mannequin`.

    positions: (P,3) m. Panels are split here, because UV differ on the two sides of a seam; normals are those of the sewn garment, so that shading runs
    smoothly over seams, but not over the ridges of folds. UV are pattern metres: a texture that repeats once a metre lies at its true size.
    """
    scene = _Scene()
    particle, split = split_at_creases(positions, cloth.particle_triangles)
    normals = particle_normals(positions[particle], split)
    panel = cloth.vertex_panel[cloth.triangles[:, 0]]
    for index, name in enumerate(cloth.panel_names):
        mine = panel == index
        if not mine.any():
            continue
        corners, triangles = np.unique(cloth.triangles[mine].astype(np.int64) * len(normals) + split[mine], return_inverse=True)
        vertices, shading = corners // len(normals), corners % len(normals)
        particles = cloth.vertex_particle[vertices]
        material = _material(name, panel_color(index), 0.9) | {"doubleSided": True}
        scene.add(f"panel_{name}", material, triangles, positions[particles], normals[shading], cloth.vertex_uv_mm[vertices] * MM_TO_M)
    if mannequin is not None:
        around = particle_normals(mannequin.vertices, mannequin.faces)
        scene.add("mannequin", _material("mannequin", BODY_COLOR, 1.0), mannequin.faces, mannequin.vertices, around)
    return write_atomic(path, scene.glb())


def panel_color(index: int) -> tuple[float, float, float]:
    """A quiet warm color; neighbours in panel order differ a little, so that panels can be told apart."""
    hue = 0.055 + 0.02 * ((index * 0.618) % 1.0 - 0.5)
    return colorsys.hls_to_rgb(hue, 0.58 + 0.08 * ((index * 0.382) % 1.0 - 0.5), 0.42)


def _material(name: str, color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness}}


class _Scene:
    """A glTF document and its one buffer, filled mesh by mesh."""

    def __init__(self) -> None:
        self._meshes: list[dict[str, Any]] = []
        self._materials: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._buffer = bytearray()

    def add(self, name: str, material: dict[str, Any], triangles: np.ndarray, points: np.ndarray, normals: np.ndarray, uv: np.ndarray | None = None) -> None:
        """A node with one mesh. uv: (N,2) with v upward; in glTF it runs downward from the top edge."""
        attributes = {"POSITION": self._stored(points, "<f4", _VERTICES), "NORMAL": self._stored(normals, "<f4", _VERTICES)}
        if uv is not None:
            attributes["TEXCOORD_0"] = self._stored(uv * [1.0, -1.0] + [0.0, 1.0], "<f4", _VERTICES)
        corners = self._stored(triangles.reshape(-1, 1), "<u4", _CORNERS)
        self._meshes.append({"name": name, "primitives": [{"attributes": attributes, "indices": corners, "material": len(self._materials)}]})
        self._materials.append(material)

    def _stored(self, rows: np.ndarray, kind: str, target: int) -> int:
        """Number of the accessor of rows (N,K), which go to the end of the buffer."""
        stored = np.ascontiguousarray(rows, dtype=kind)
        self._views.append({"buffer": 0, "byteOffset": len(self._buffer), "byteLength": stored.nbytes, "target": target})
        self._buffer += stored.tobytes()
        self._accessors.append({
            "bufferView": len(self._views) - 1, "componentType": _FLOAT if kind == "<f4" else _UNSIGNED, "type": _KIND[stored.shape[1]],
            "count": len(stored), "min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist(),
        })  # fmt: skip
        return len(self._accessors) - 1

    def glb(self) -> bytes:
        """The file: a header, the document, the buffer."""
        count = len(self._meshes)
        document = {
            "asset": {"version": "2.0", "generator": f"garmentcad {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": list(range(count))}],
            "nodes": [{"name": mesh["name"], "mesh": number} for number, mesh in enumerate(self._meshes)],
            "meshes": self._meshes, "materials": self._materials, "accessors": self._accessors, "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._buffer)}],
        }  # fmt: skip
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(self._buffer), b"BIN\0") + self._buffer
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
