"""A garment on its body: how far each particle is from it, and what the body gives to those that it touches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.analysis.penetration import distances_and_normals
from garmentcad.analysis.pressure import ContactPressure, contact_pressure
from garmentcad.analysis.tributary import draped_areas
from garmentcad.cloth.cloth import Cloth
from garmentcad.contact.body import kept_gap
from garmentcad.fabric.material import MaterialTable
from garmentcad.mannequin.mannequin import Mannequin


@dataclass(frozen=True)
class OnBody:
    """distance_m: (P,) signed distance of the particles from the body; pressure: of the body on them."""

    distance_m: np.ndarray
    pressure: ContactPressure


def on_body(cloth: Cloth, materials: MaterialTable, mannequin: Mannequin, positions: np.ndarray, forces_n: np.ndarray) -> OnBody:
    """Distance and pressure at positions (P,3) m. forces_n: (P,3) N of the laws and weight at rest, contact left out."""
    vertices, faces = mannequin.vertices, mannequin.faces
    distance, normal = distances_and_normals(positions, vertices, faces)
    gap = kept_gap(cloth, materials, vertices, faces, cKDTree(vertices).query(positions)[1])
    return OnBody(distance, contact_pressure(forces_n, normal, distance, gap, draped_areas(cloth, positions)))
