"""Findings on what may have been forgotten to be sewn: two edges that lie together from where a seam ends, edges whose mirror twins alone
are sewn, and parts of a garment that nothing joins."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from garmentcad.check.finding import Finding
from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.angle import arctan2
from garmentcad.pattern.names import SUFFIX
from garmentcad.pattern.pattern import Panel, Pattern, edge_roles

_ALIKE_MM, _ALIKE_SHARE = 3.0, 0.02  # two lengths are those of one seam, as in seam.py
# Estimates, under which 79 of 104 seams taken out of the shipped garments are named (91 with mirror twins) and none in whole ones.
_EASED_SHARE = 0.5  # where both begin and end together, one of them may be eased, stretched or gathered onto the other
_CLOSED = np.radians(300.0)  # of cloth around a point: two edges lie together, and are no hem or neckline, which turn on by some 180 degrees
_TURNED = np.radians(45.0)  # a corner around which no seam goes
_STRAIGHT = np.radians(20.0)  # an edge that goes on in the line of what is sewn: a slit, a placket, a vent


class _Run(NamedTuple):
    """Edges of a panel from one point on that are sewn to nothing, as they follow one another. edges: PANEL.EDGE of each; start, end: particles of the sewn
    cloth; goes_on: whether the outline goes straight on at the start; length: mm; roles: of all of them."""

    edges: tuple[str, ...]
    start: int
    end: int
    goes_on: bool
    length: float
    roles: frozenset[str | None]

    @property
    def has_role(self) -> bool:
        """Whether one of the edges has a role."""
        return self.roles != {None}


def check_unsewn(pattern: Pattern, sewn: Cloth, file: str | None = None) -> Iterator[Finding]:
    """Pairs of runs of edges that begin at one point of the sewn cloth, with as much cloth around it as if they lay together, and not both in the line of what
    is sewn. They end together as well, or are as long as each other and have no role. Of hems and cuffs nothing is said, nor of two edges of a neck opening.
    Then what only its twin is sewn."""
    angle = _angles(sewn)
    around = np.bincount(sewn.vertex_particle, angle, sewn.particle_count)
    starts: defaultdict[int, list[list[_Run]]] = defaultdict(list)
    for runs in _open_runs(pattern, sewn, angle, around):
        starts[runs[0].start].append(runs)
    told: set[str] = set()
    for start, beside in starts.items():
        for ones, twos in combinations(beside, 2) if around[start] > _CLOSED else ():
            if ones[0].goes_on and twos[0].goes_on:
                continue
            pairs = [pair for pair in product(ones, twos) if _match(*pair)]
            if not pairs:
                continue
            one, two = max(pairs, key=lambda pair: (not (pair[0].has_role or pair[1].has_role), pair[0].length))
            if told.issuperset((*one.edges, *two.edges)):
                continue
            told.update((*one.edges, *two.edges))
            sides = [" and ".join(run.edges) for run in (one, two)]
            yield Finding(
                "warning", "edges-unsewn", file, f"panels.{one.edges[0].replace('.', '.edges.', 1)}",
                f"{sides[0]} ({one.length:.0f} mm) and {sides[1]} ({two.length:.0f} mm) lie together from where a seam ends, and are sewn to nothing",
                "Sew them together; edges that are meant to be open have the role hem, cuff or neck.",
            )  # fmt: skip
    yield from _check_twins(pattern, told, file)


def _check_twins(pattern: Pattern, told: set[str], file: str | None) -> Iterator[Finding]:
    """Edges without a role that are sewn to nothing while their mirror twins are sewn, those of one seam together. told: keys of which it is said already."""
    sewn = {seam.name: [f"{use.panel}.{pattern.panels[use.panel].edges[use.edge].name}" for use in (*seam.a, *seam.b)] for seam in pattern.seams}
    silent = told.union(*sewn.values(), *edge_roles(pattern).values())
    twins = _twins(pattern)
    for seam, edges in sewn.items():
        open_edges = {twin: edge for edge in edges for twin in twins[edge] if twin not in silent}
        if open_edges:
            silent.update(open_edges)
            first, sides = next(iter(open_edges)), [" and ".join(dict.fromkeys(names)) for names in (open_edges, open_edges.values())]
            yield Finding(
                "note", "edges-unsewn", file, f"panels.{first.replace('.', '.edges.', 1)}",
                f"{sides[0]}: sewn to nothing, while on the mirrored side seam {seam} sews {sides[1]}",
                "Sew both sides alike; edges that are meant to be open have a role (hem, neck, armhole, ...).",
            )  # fmt: skip


def _twins(pattern: Pattern) -> defaultdict[str, list[str]]:
    """PANEL.EDGE of the mirror twins of an edge PANEL.EDGE: in the other half of an unfolded panel, and in the panel that is mirrored from its own."""
    twins: defaultdict[str, list[str]] = defaultdict(list)
    for panel in pattern.panels.values():
        for edge in panel.edges:
            mine = f"{panel.name}.{edge.name}"
            others = [mine.removesuffix(SUFFIX)] if edge.image else []
            others += [] if panel.mirrored_from is None else [f"{panel.mirrored_from}.{edge.name}"]
            for other in others:
                twins[mine].append(other)
                twins[other].append(mine)
    return twins


def _match(one: _Run, two: _Run) -> bool:
    """Whether two runs from one point may be the sides of a seam."""
    longer, shorter = max(one.length, two.length), min(one.length, two.length)
    together = one.end == two.end
    allowed = _EASED_SHARE * longer if together else max(_ALIKE_MM, _ALIKE_SHARE * longer)
    # The two sides of the opening of a hood end together, too. Other roles stand on edges that are sewn.
    open_by_role = one.roles | two.roles == {"neck"} if together else one.has_role or two.has_role
    return longer - shorter <= allowed and not set(one.edges) & set(two.edges) and not open_by_role


def check_apart(pattern: Pattern, sewn: Cloth, loose: np.ndarray, file: str | None = None) -> Iterator[Finding]:
    """Parts of a garment that neither seams nor buttons, elastics or belts join to its largest part, and no pin holds. loose (panels,) bool: those of which it
    is told already that nothing holds them."""
    index = {name: k for k, name in enumerate(sewn.panel_names)}
    joined = [(button.button.panel, button.buttonhole.panel) for button in pattern.buttons]
    joined += [(one[0].panel, two[0].panel) for band in pattern.bands for one, two in zip(band.lines, band.lines[1:])]
    together = panels_together(sewn, [(index[a], index[b]) for a, b in joined])
    sizes = np.bincount(together[sewn.vertex_panel[sewn.triangles[:, 0]]])
    pinned = [index[pin.at.panel] for pin in pattern.pins]
    for part in np.unique(together[~loose]):
        if part != np.argmax(sizes) and part not in together[pinned]:
            names = [name for name, where in zip(sewn.panel_names, together) if where == part]
            yield Finding(
                "note", "not-joined", file, f"panels.{names[0]}",
                f"{', '.join(names)}: no seam, button, elastic or belt joins {'it' if len(names) == 1 else 'them'} to the rest of the garment",
                "Sew it to the rest, if it shall be.",
            )  # fmt: skip


def panels_together(sewn: Cloth, joined: list[tuple[int, int]] | None = None) -> np.ndarray:
    """(panels,) the same number for panels that share particles, directly or over others. joined: pairs of panels that something else joins, too."""
    count = len(sewn.panel_names)
    lies_on = coo_array((np.ones(len(sewn.vertex_panel)), (sewn.vertex_panel, sewn.vertex_particle)), shape=(count, sewn.particle_count)).tocsr()
    pairs = np.array(joined or [], dtype=np.int64).reshape(-1, 2)
    other = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(lies_on @ lies_on.T + other, directed=False)[1])


def _open_runs(pattern: Pattern, sewn: Cloth, angle: np.ndarray, around: np.ndarray) -> Iterator[list[_Run]]:
    """From each corner of each panel both ways along its outline: the runs of one, two and more open edges, over sewn darts, up to where another panel is sewn
    on or the outline turns. angle: (V,) of the panel at each vertex, around: (P,) of the cloth around each particle, rad."""
    used = {(use.panel, use.edge) for seam in pattern.seams for use in (*seam.a, *seam.b)}
    lies_on = np.unique(np.stack([sewn.vertex_particle, sewn.vertex_panel], axis=1), axis=0)
    panels_at = np.bincount(lies_on[:, 0], minlength=sewn.particle_count)
    for panel in pattern.panels.values():
        edges = panel.edges
        corners = _corners(sewn, panel)
        at = sewn.vertex_particle[corners].tolist()
        is_open = [(panel.name, k) not in used and edge.role not in ("hem", "cuff") and edge.dart is None for k, edge in enumerate(edges)]
        for first, way in product(range(len(edges)), (1, -1)):
            goes_on = bool(abs(angle[corners[first]] - np.pi) < _STRAIGHT)
            runs: list[_Run] = []
            passed: list[int] = []
            corner = first
            while len(passed) < len(edges):
                edge = corner if way > 0 else corner - 1
                if not is_open[edge]:
                    break
                passed.append(edge % len(edges))
                corner = (corner + way) % len(edges)
                names = tuple(dict.fromkeys(f"{panel.name}.{edges[k].name}" for k in passed))
                length, roles = sum(edges[k].curve.length for k in passed), frozenset(edges[k].role for k in passed)
                runs.append(_Run(names, at[first], at[corner], goes_on, length, roles))
                if panels_at[at[corner]] > 1 or abs(around[at[corner]] - np.pi) > _TURNED:
                    break
                corner = next((k for k in range(len(edges)) if k != corner and at[k] == at[corner]), corner)  # the other side of a dart's mouth
            if runs:
                yield runs


def _corners(cloth: Cloth, panel: Panel) -> np.ndarray:
    """(E,) the vertex at which each edge of a panel begins."""
    mine = np.flatnonzero((cloth.vertex_panel == cloth.panel_names.index(panel.name)) & cloth.vertex_on_contour)
    return mine[cKDTree(cloth.vertex_uv_mm[mine]).query([edge.curve.start for edge in panel.edges])[1]]


def _angles(cloth: Cloth) -> np.ndarray:
    """(V,) angle of the flat panel at each vertex, rad."""
    corners = cloth.vertex_uv_mm[cloth.triangles]
    found = np.zeros(len(cloth.vertex_panel))
    for k in range(3):
        one, two = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angle = arctan2(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], (one * two).sum(axis=1))
        found += np.bincount(cloth.triangles[:, k], angle, len(found))
    return found
