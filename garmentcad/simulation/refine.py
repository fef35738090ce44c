"""From a coarse lattice to a finer one of the same garment: every fine vertex goes where the coarse panel has its point.

Linear on the coarse triangles: links then keep their rest lengths (a smooth interpolant would be longer than the chords, by 4 % where a fold of 20 mm
radius lies on a lattice of 20 mm), and fine triangles stay on the coarse surface, which crosses nothing. Bending settles afterwards.

Internal friction goes over as moment and stress, not as sliders: fine triangles inside a coarse one are flat, whatever it was bent by. Each fine slider is set
so that its stick spring is drawn as far as that of the nearest coarse one of the same curve.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.locate import located
from garmentcad.cloth.state import State
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.force import CURVES, NO_PARTICLE, Gauge


def refined(coarse: Cloth, values: np.ndarray, fine: Cloth) -> np.ndarray:
    """Values (P,N) at the particles of `fine`, such as positions, from those at the particles of `coarse`; where several vertices became one particle,
    their mean.

    Vertices of a convex contour lie outside the chords of the coarse one: they continue its triangles.
    """
    found = np.empty((len(fine.vertex_panel), values.shape[1]))
    for panel in range(len(coarse.panel_names)):
        mine = np.flatnonzero(fine.vertex_panel == panel)
        place = located(coarse, panel, fine.vertex_uv_mm[mine])
        found[mine] = np.einsum("nk,nkx->nx", place.weights, values[coarse.vertex_particle[place.vertices]])
    count = np.bincount(fine.vertex_particle, minlength=fine.particle_count)
    return np.column_stack([np.bincount(fine.vertex_particle, found[:, axis], fine.particle_count) / count for axis in range(values.shape[1])])


def refined_sliders(coarse: Cloth, before: ForceAssembly, state: State, fine: Cloth, after: ForceAssembly, positions: np.ndarray) -> dict[str, np.ndarray]:
    """Sliders for the forces `after` of `fine` at `positions`, from those of `state`, which belong to the forces `before` of `coarse`."""
    panel, uv, curve, drawn = [], [], [], []
    for force in before.forces:
        gauge = Gauge(*(column.ravel() for column in force.gauge(state.positions)))
        used = np.flatnonzero((gauge.particle != NO_PARTICLE) & (gauge.way > 0.0))
        vertex = _first_vertex(coarse)[gauge.particle[used].astype(np.int64)]
        panel.append(coarse.vertex_panel[vertex])
        uv.append(coarse.vertex_uv_mm[vertex])
        curve.append(gauge.curve[used])
        drawn.append(np.clip((gauge.strain[used] - state.friction[force.name].ravel()[used]) / gauge.way[used], -1.0, 1.0))
    known = np.concatenate(panel) * len(CURVES) + np.concatenate(curve)
    places, share = np.concatenate(uv), np.concatenate(drawn)
    made = after.slack()
    for force in after.forces:
        gauge = Gauge(*(column.ravel() for column in force.gauge(positions)))
        used = np.flatnonzero(gauge.particle != NO_PARTICLE)
        vertex = _first_vertex(fine)[gauge.particle[used].astype(np.int64)]
        key = fine.vertex_panel[vertex] * len(CURVES) + gauge.curve[used]
        for kind in np.intersect1d(key, known):
            there, here = np.flatnonzero(known == kind), used[key == kind]
            nearest = there[cKDTree(places[there]).query(fine.vertex_uv_mm[vertex[key == kind]])[1]]
            made[force.name].reshape(-1)[here] = gauge.strain[here] - gauge.way[here] * share[nearest]
    return made


def _first_vertex(cloth: Cloth) -> np.ndarray:
    """(P,) the first vertex of each particle."""
    return np.unique(cloth.vertex_particle, return_index=True)[1]
