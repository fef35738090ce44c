"""A rectangular specimen as it is cut for a tester: y runs along it, from clamp to clamp, x across it; it begins flat in the plane z = 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from garmentcad.cloth.cloth import ContourSpans
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.force import BodyForce
from garmentcad.forces.internal import internal_forces
from garmentcad.rigs.equilibrium import Equilibrium
from garmentcad.units import MM_TO_M

ANGLES = {"warp": 0.0, "weft": 90.0, "bias": 45.0}  # degrees from the length of a specimen to its warp


class Specimen:
    """width x length mm of the fabric in row 0 of `materials`, its warp `angle_deg` from its length.

    origin_mm: a point of the rectangle through which a lattice line of either direction passes; by default the lattice is symmetric. stays_flat: motion out of
    the plane is left out. weight: what acts beside the internal forces, from the masses.
    """

    def __init__(
        self,
        materials: MaterialTable,
        width_mm: float,
        length_mm: float,
        grid_mm: float,
        angle_deg: float,
        origin_mm: tuple[float, float] | None = None,
        *,
        stays_flat: bool,
    ) -> None:
        self.width = width_mm * MM_TO_M
        self.cloth = rectangle_cloth(width_mm, length_mm, grid_mm, angle_deg, materials, origin_mm=origin_mm)
        self.rest = np.column_stack([MM_TO_M * self.cloth.vertex_uv_mm, np.zeros(self.cloth.particle_count)])
        self.axes = (0, 1) if stays_flat else (0, 1, 2)
        self._materials = materials
        self.balance = self.under()

    def hold(self, *clamps: np.ndarray) -> None:
        """Clamps hold these particles from here on. Contour spans that reach out of a clamp are left out, as those that a fold crosses: curvature begins
        at a clamp all at once, which is as good as a saw tooth to them."""
        spans = self.cloth.spans
        keep = np.ones(len(spans.corners), dtype=bool)
        for held in clamps:
            inside = np.isin(spans.corners, held).sum(axis=1)
            keep &= (inside == 0) | (inside == spans.corners.shape[1])
        self.cloth = replace(self.cloth, spans=ContourSpans(*(column[keep] for column in spans)))
        self.balance = self.under()

    def under(self, *body_forces: BodyForce) -> Equilibrium:
        """Its equilibrium under internal forces and these."""
        forces = ForceAssembly(internal_forces(self.cloth, self._materials), self.cloth.particle_count, body_forces)
        return Equilibrium(self.cloth, forces, self.axes)

    @property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Particles of the edges y = 0 and y = length."""
        return self.cloth.edge_vertices["rectangle.bottom"], self.cloth.edge_vertices["rectangle.top"]

    def modes(self, held: Sequence[np.ndarray], moving: Sequence[tuple[np.ndarray, int]] = ()) -> csr_array:
        """What may change: coordinates of particles in no list of `held`, then, for each pair of `moving`, one coordinate shared by those particles."""
        free = np.zeros(self.rest.shape, dtype=bool)
        free[:, self.axes] = True
        for particles in held:
            free[particles] = False
        rows = [np.flatnonzero(free.ravel()), *(3 * particles.astype(np.int64) + axis for particles, axis in moving)]
        alone = len(rows[0])
        columns = [np.arange(alone), *(np.full(len(shared), alone + k) for k, shared in enumerate(rows[1:]))]
        entries = (np.ones(sum(map(len, rows))), (np.concatenate(rows), np.concatenate(columns)))
        return csr_array(entries, shape=(self.rest.size, alone + len(moving)))
