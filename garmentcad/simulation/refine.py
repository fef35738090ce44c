"""From a coarse lattice to a finer one of the same garment: every fine vertex goes where the coarse panel has its point.

Linear on the coarse triangles: links then keep their rest lengths (a smooth interpolant would be longer than the chords, by 4 % where a fold of 20 mm
radius lies on a lattice of 20 mm), and fine triangles stay on the coarse surface, which crosses nothing. Bending settles afterwards.

Internal friction goes over as moment and stress, not as sliders: fine triangles inside a coarse one are flat, whatever it was bent by. Each fine slider is set
so that its stick spring is drawn as far as that of the nearest coarse one of the same curve.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.arrays import rows_by_key
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
    kind, uv, drawn = [], [], []
    for force in before.forces:
        gauge = _in_rows(force.gauge(state.positions))
        used = np.flatnonzero((gauge.particle != NO_PARTICLE) & (gauge.way > 0.0))
        panel, places = _places(coarse, gauge, used)
        kind.append(panel * len(CURVES) + gauge.curve[used])
        uv.append(places)
        drawn.append(np.clip((gauge.strain[used] - state.friction[force.name].ravel()[used]) / gauge.way[used], -1.0, 1.0))
    known, at, share = (np.concatenate(columns) for columns in (kind, uv, drawn))
    made = after.slack()
    for force in after.forces:
        gauge = _in_rows(force.gauge(positions))
        used = np.flatnonzero(gauge.particle != NO_PARTICLE)
        panel, places = _places(fine, gauge, used)
        key = panel * len(CURVES) + gauge.curve[used]
        for one in np.intersect1d(key, known):
            there, here = np.flatnonzero(known == one), used[key == one]
            nearest = there[cKDTree(at[there]).query(places[key == one])[1]]
            made[force.name].reshape(-1)[here] = gauge.strain[here] - gauge.way[here] * share[nearest]
    return made


def _in_rows(gauge: Gauge) -> Gauge:
    rows = {name: column.ravel() for name, column in gauge._asdict().items()}
    return Gauge(**rows | {"between": gauge.between.reshape(-1, 4)})


def _places(cloth: Cloth, gauge: Gauge, used: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Panel (N,) and place on it (N,2) mm of the sliders `used` (N,): of the panels of its particle the one on which most of those lie between which it is, and
    their mean."""
    starts, rows = rows_by_key(cloth.vertex_particle, cloth.particle_count)
    first, between = gauge.particle[used].astype(np.int64), gauge.between[used].astype(np.int64)
    panel, place, most = np.zeros(len(used), dtype=np.int64), np.zeros((len(used), 2)), np.full(len(used), -1.0)
    for own, mine in _vertices(starts, rows, first):
        total, count = np.zeros((len(own), 2)), np.zeros(len(own))
        for column in between[mine].T:
            found, least = np.zeros((len(own), 2)), np.full(len(own), np.inf)
            for vertex, there in _vertices(starts, rows, column):
                # of several vertices of one particle, as beside a dart, the nearest
                way = np.linalg.norm(cloth.vertex_uv_mm[vertex] - cloth.vertex_uv_mm[own[there]], axis=1)
                nearer = (cloth.vertex_panel[vertex] == cloth.vertex_panel[own[there]]) & (way < least[there])
                least[there[nearer]], found[there[nearer]] = way[nearer], cloth.vertex_uv_mm[vertex[nearer]]
            total, count = total + found, count + np.isfinite(least)
        better = (count > most[mine]) & (count > 0.0)
        chosen = mine[better]
        panel[chosen], place[chosen], most[chosen] = cloth.vertex_panel[own[better]], total[better] / count[better, None], count[better]
    return panel, place


def _vertices(starts: np.ndarray, rows: np.ndarray, particles: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The first vertex of each of the particles (N,) that is one, then the second of those that have two, and so on: the vertices, and whose they are."""
    for k in range(int(np.diff(starts).max(initial=0))):
        there = np.flatnonzero((particles != NO_PARTICLE) & (starts[particles] + k < starts[particles + 1]))
        yield rows[starts[particles[there]] + k], there
