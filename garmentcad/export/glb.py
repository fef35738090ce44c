"""Binary glTF (GLB) of a draped garment on its mannequin: one mesh a panel with its own material, texture coordinates in metres on the pattern."""

from __future__ import annotations

import colorsys
from pathlib import Path

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from garmentcad.cloth.cloth import Cloth
from garmentcad.export.normals import particle_normals
from garmentcad.io.atomic import write_atomic
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import MM_TO_M

BODY_COLOR = (0.62, 0.62, 0.64)


def write_garment_glb(path: str | Path, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin | None = None) -> Path:
    """Write a scene with a node `panel_NAME` for each panel and, where given, a node `mannequin`.

    positions: (P,3) m. Panels are split here, because UV differ on the two sides of a seam; normals are those of the sewn garment, so that shading runs
    smoothly over seams. UV are pattern metres: a texture that repeats once a metre lies at its true size.
    """
    scene = trimesh.Scene()
    normals = particle_normals(positions, cloth.particle_triangles)
    panel = cloth.vertex_panel[cloth.triangles[:, 0]]
    for index, name in enumerate(cloth.panel_names):
        vertices, triangles = np.unique(cloth.triangles[panel == index], return_inverse=True)
        if len(vertices) == 0:
            continue
        particles = cloth.vertex_particle[vertices]
        mesh = trimesh.Trimesh(positions[particles], triangles.reshape(-1, 3), vertex_normals=normals[particles], process=False)
        material = PBRMaterial(name=name, baseColorFactor=[*panel_color(index), 1.0], metallicFactor=0.0, roughnessFactor=0.9, doubleSided=True)
        mesh.visual = trimesh.visual.TextureVisuals(uv=cloth.vertex_uv_mm[vertices] * MM_TO_M, material=material)
        scene.add_geometry(mesh, node_name=f"panel_{name}", geom_name=f"panel_{name}")
    if mannequin is not None:
        body = trimesh.Trimesh(mannequin.vertices, mannequin.faces, process=False)
        material = PBRMaterial(name="mannequin", baseColorFactor=[*BODY_COLOR, 1.0], metallicFactor=0.0, roughnessFactor=1.0)
        body.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(body, node_name="mannequin", geom_name="mannequin")
    return write_atomic(path, scene.export(file_type="glb", include_normals=True))


def panel_color(index: int) -> tuple[float, float, float]:
    """A quiet warm color; neighbours in panel order differ a little, so that panels can be told apart."""
    hue = 0.055 + 0.02 * ((index * 0.618) % 1.0 - 0.5)
    return colorsys.hls_to_rgb(hue, 0.58 + 0.08 * ((index * 0.382) % 1.0 - 0.5), 0.42)
