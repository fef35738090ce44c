"""Findings on wearing: rings of the garment that are too small for the body inside them, or for what they have to pass when the garment is put on.

Rings are cut from the sewn pattern as it is laid around the body: closed lines around the trunk, the neck, an arm or a leg, measured on the flat panels.
How far a ring extends follows from the fabric along its every part (`fabric/extension.py`). What a button closes is no ring, and zips are open while a
garment is put on.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from garmentcad.analysis.passing import STEP_M
from garmentcad.analysis.section import Chain, Plane, cut, horizontal
from garmentcad.check.body_part import HURTS_PA, BodyPart, body_parts
from garmentcad.check.finding import Finding
from garmentcad.check.holding import check_belts, check_falling, check_held
from garmentcad.check.unsewn import check_unsewn
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.weld import weld_seams
from garmentcad.fabric.extension import extension
from garmentcad.fabric.material import MaterialTable
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern, Wrap
from garmentcad.units import MM_TO_M

_PULL_N_M = 490.3  # tension of a ring that is pulled over something, 500 gf/cm as testers pull; an estimate
_SLACK_M = 0.045  # a ring may come to lie higher or lower on the body than it was laid by this, and by what its seams stand open
_ANGLES = 90  # directions between warp and weft that are told apart
_LEAST_MM = 3.0
_LIMBS = ("arm", "leg")
# A short sleeve that closes beside the arm at its hem (4 levels of 6 of the knit top on `man-100`) finds its way from where it goes around: an estimate.
_BESIDE_M = 0.2
_LEAST_SPAN = np.radians(60.0)  # around a limb; the girth of a wrist, laid on the cylinder of its arm, spans 105 degrees


@dataclass(frozen=True)
class Ring:
    """A closed line around a part of the body. level: along its axis, m; steps (S,2) mm on the flat panels, their cosines (S,) to warp, their rows (S,) of the
    material table."""

    level: float
    steps: np.ndarray
    along_warp: np.ndarray
    rows: np.ndarray

    @property
    def length_mm(self) -> float:
        return float(np.hypot(self.steps[:, 0], self.steps[:, 1]).sum())

    def extended_mm(self, materials: MaterialTable, force: float | None) -> float:
        """Length when every part is pulled with `force` N/m; None: with the force to which its own fabric was tested (Fm)."""
        lengths, place = np.hypot(self.steps[:, 0], self.steps[:, 1]), np.rint(self.along_warp * _ANGLES).astype(int)
        found = 0.0
        for row, at in set(zip(self.rows.tolist(), place.tolist(), strict=True)):
            pull = float(materials.tension_force[row].max()) if force is None else force
            found += float(lengths[(self.rows == row) & (place == at)].sum()) * (1.0 + extension(materials, row, at / _ANGLES, pull))
        return found


class _Laid(NamedTuple):
    """How a garment lies around a part of the body. rings: the shortest at each level where there is one, and the openings of the garment around the part;
    ringed (panels,) bool: over which any ring goes; of a limb tubes (panels,): at how many levels a ring of what is wrapped on it goes over the panel, and
    beside (panels,): at how many of them it leaves the middle of the limb outside, because what is laid on the large cylinder of its limb spans little of it.
    """

    rings: list[Ring]
    ringed: np.ndarray
    tubes: np.ndarray
    beside: np.ndarray


def check_wearing(
    pattern: Pattern, cloth: Cloth, positions: np.ndarray, materials: MaterialTable, body: Mannequin, file: str | None = None
) -> Iterator[Finding]:
    """Findings on an unsewn cloth at positions (V,3) m. SpecError where the seams cannot be welded."""
    seams = [seam.name for seam in pattern.seams]
    sewn = [seam.name for seam in pattern.seams if seam.closed is None]
    worn = _sewn(cloth, positions, seams)
    put_on = worn if sewn == seams else _sewn(cloth, positions, sewn)
    held = np.zeros(len(pattern.panels), dtype=bool)
    for part in body_parts(body):
        slack = _SLACK_M + _open_along(part.axis, positions, worn[0].vertex_particle)
        laid = _laid(pattern, *worn, part)
        rings = laid.rings
        held |= laid.ringed
        yield from _check_beside(laid, cloth.panel_names, part, file)
        if part.name == "torso":
            yield from check_falling(pattern, *worn, part, [(ring.level, ring.length_mm) for ring in rings], body, file)
            yield from check_belts(pattern, *worn, part, slack, file)
        yield from _check_ease(rings, part, slack, materials, file)
        yield from _check_passing(rings if put_on is worn else _laid(pattern, *put_on, part).rings, part, materials, file)
    yield from check_unsewn(pattern, worn[0], file)
    if body.cylinders:
        yield from check_held(pattern, worn[0], held, file)


def _sewn(cloth: Cloth, positions: np.ndarray, seams: Collection[str]) -> tuple[Cloth, np.ndarray]:
    """The cloth with `seams` welded, and its particles (P,3) in the middle of the vertices that became one."""
    sewn, _ = weld_seams(cloth, seams)
    count = np.bincount(sewn.vertex_particle, minlength=sewn.particle_count)
    middle = [np.bincount(sewn.vertex_particle, positions[:, axis], sewn.particle_count) / count for axis in range(3)]
    return sewn, np.stack(middle, axis=1)


def _open_along(axis: np.ndarray, positions: np.ndarray, particle: np.ndarray) -> float:
    """How far apart along `axis`, m, vertices at positions (V,3) lie that become one particle (V,): so far panels still go."""
    along = positions @ axis
    high, low = np.full(particle.max() + 1, -np.inf), np.full(particle.max() + 1, np.inf)
    np.maximum.at(high, particle, along)
    np.minimum.at(low, particle, along)
    return float((high - low).max())


def _laid(pattern: Pattern, cloth: Cloth, positions: np.ndarray, part: BodyPart) -> _Laid:
    flat, particle_triangles, found = cloth.vertex_uv_mm[cloth.triangles], cloth.particle_triangles, []
    grain = np.radians([pattern.panels[name].grain_deg for name in cloth.panel_names])
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    warp = np.stack([-np.sin(grain), np.cos(grain)], axis=1)[owner]
    rules = [pattern.panels[name].placement for name in cloth.panel_names]
    limb = part.name.startswith(_LIMBS)
    ringed = np.zeros(len(cloth.panel_names), dtype=bool)
    tubes, beside = np.zeros((2, len(cloth.panel_names)), dtype=np.int64)
    wrapped = np.array([isinstance(rule, Wrap) and rule.part == part.name for rule in rules])[owner]

    def ring(level: float, steps: np.ndarray, triangles: np.ndarray) -> Ring:
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        cosine = np.abs((steps * warp[triangles]).sum(axis=1)) / np.where(lengths > 0.0, lengths, 1.0)
        return Ring(level, steps, cosine, cloth.triangle_material[triangles])

    def center(level: float) -> np.ndarray:
        return np.asarray(part.origin + (level - part.origin @ part.axis) * part.axis)

    def around(chain: Chain, plane: Plane) -> bool:
        """A narrow cuff is laid as less than half a turn, since panels are wrapped unstretched: on a limb it counts that all of a ring is wrapped there.
        Not so the little loops where a hem lies over the cuff to which it is sewn."""
        if not chain.closed or chain.winds_around(center(plane.offset), plane):
            return chain.closed
        return limb and bool(wrapped[chain.triangles].all()) and chain.span_around(center(plane.offset), plane) > _LEAST_SPAN

    def over_head(chain: Chain) -> bool:
        """What is laid above the head falls over it, to the neck."""
        return part.name == "neck" and float(chain.points[:, 1].min()) > part.top[1] and chain.winds_around(part.top, horizontal(float(part.top[1])))

    for level, middle in zip(part.levels.tolist(), part.middles):
        plane = Plane(part.axis, level)
        chains = [chain for chain in cut(positions, particle_triangles, plane) if around(chain, plane)]
        for chain in chains:
            panels = np.unique(owner[chain.triangles])
            ringed[panels] = True
            if limb and wrapped[chain.triangles].all():
                tubes[panels] += 1
                beside[panels] += not chain.winds_around(middle, plane)
        if chains:
            found.append(min((ring(level, chain.steps_on(flat), chain.triangles) for chain in chains), key=lambda found: found.length_mm))
    for triangles, corners in openings(particle_triangles):
        level = float((positions[particle_triangles[triangles, corners]] @ part.axis).mean())
        seen = Chain(positions[particle_triangles[triangles, corners]], triangles, True, corners, corners, corners, corners)
        if over_head(seen) or (part.levels[0] <= level <= part.levels[-1] and around(seen, Plane(part.axis, level))):
            ringed[owner[triangles]] = True
            found.append(ring(level, flat[triangles, (corners + 1) % 3] - flat[triangles, corners], triangles))
    return _Laid(found, ringed, tubes, beside)


def _check_beside(laid: _Laid, names: Sequence[str], part: BodyPart, file: str | None) -> Iterator[Finding]:
    """Tubes that close beside their limb all along, or over more than half of their length and _BESIDE_M."""
    long = (2 * laid.beside > laid.tubes) & (laid.beside * STEP_M > _BESIDE_M)
    for panel in np.flatnonzero((laid.tubes > 0) & ((laid.beside == laid.tubes) | long)).tolist():
        yield Finding(
            "warning", "tube-beside-limb", file, f"panels.{names[panel]}.placement.wrap",
            f"as {names[panel]} is laid, its seams close beside the {part.said} and not around it: it spans less of the cylinder on which it is wrapped "
            "than it would have to",
            "Wrap it closer to the limb, so that it goes more than half around: a scale below 1, a smaller offset, or a flare.",
        )  # fmt: skip


def openings(triangles: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Closed borders of a mesh of triangles (F,3): for each the triangle of every edge in order, and the corner (0 to 2) at which the edge begins."""
    begin, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    _, place, count = np.unique(low.astype(np.int64) * (int(triangles.max()) + 1) + high, return_inverse=True, return_counts=True)
    border = np.flatnonzero(count[place] == 1)
    after = {int(begin[edge]): int(edge) for edge in border}
    found: list[tuple[np.ndarray, np.ndarray]] = []
    used: set[int] = set()
    for first in border.tolist():
        loop: list[int] = []
        edge = first
        while edge >= 0 and edge not in used:
            used.add(edge)
            loop.append(edge)
            edge = after.get(int(end[edge]), -1)  # -1: right sides are sewn on wrong sides there, and the border turns around
        if loop and edge == first:
            found.append((np.array(loop) // 3, np.array(loop) % 3))
    return found


def _check_ease(rings: list[Ring], part: BodyPart, slack: float, materials: MaterialTable, file: str | None) -> Iterator[Finding]:
    """The ring that is worst off on the body, wherever within `slack` m it comes to lie: too small for it at any pull that can be worn, or only at one beyond
    what its fabric was tested to."""
    if part.name == "neck":  # where a collar lies is not known before it is draped
        return
    worst: tuple[float, Ring, float, float] | None = None
    for ring in rings:
        near = part.girths[(np.abs(part.levels - ring.level) <= slack) & (part.girths > 0.0)]
        girth = float(near.min()) if len(near) else 0.0
        if ring.length_mm < girth - _LEAST_MM:
            tight = ring.extended_mm(materials, None)
            if tight < girth and (worst is None or tight - girth < worst[0]):
                worst = (tight - girth, ring, girth, tight)
    if worst is None:
        return
    _, ring, girth, tested = worst
    worn = ring.extended_mm(materials, HURTS_PA * girth * MM_TO_M / (2.0 * np.pi))
    bad = worn < girth
    yield Finding(
        "error" if bad else "warning", "ease-impossible" if bad else "stretch-untested", file, None,
        f"around the {part.said}, {_level_mm(ring, part):.0f} mm up, the garment measures {ring.length_mm:.0f} mm and the body {girth:.0f} mm: "
        f"it has to stretch by {100.0 * (girth / ring.length_mm - 1.0):.1f} %, and its fabric gives {100.0 * (tested / ring.length_mm - 1.0):.1f} % "
        "at the force of its sheet (EMT)"
        + (f", {100.0 * (worn / ring.length_mm - 1.0):.1f} % at the largest pressure that can be worn" if bad else ""),
        f"Make it at least {girth - tested:.0f} mm wider there, or take a fabric with more EMT around the body.",
    )  # fmt: skip


def _check_passing(rings: list[Ring], part: BodyPart, materials: MaterialTable, file: str | None) -> Iterator[Finding]:
    """The ring that is farthest from passing what it must."""
    worst: tuple[float, Ring, float] | None = None
    for ring in rings:
        needed = float(np.interp(ring.level, part.levels, part.passed))
        if ring.length_mm < needed:
            short = needed - ring.extended_mm(materials, _PULL_N_M)
            if short > _LEAST_MM and (worst is None or short > worst[0]):
                worst = (short, ring, needed)
    if worst is not None:
        short, ring, needed = worst
        yield Finding(
            "warning", "closure-missing", file, None,
            f"the garment cannot be put on: around the {part.said}, {_level_mm(ring, part):.0f} mm up, it measures {ring.length_mm:.0f} mm, "
            f"pulled {needed - short:.0f} mm, and has to pass the {part.by} of {needed:.0f} mm",
            f"Leave an opening of {short:.0f} mm or more there, closed by a zip or buttons, make it wider, or take a fabric that stretches.",
        )  # fmt: skip


def _level_mm(ring: Ring, part: BodyPart) -> float:
    """Height above the floor of the ring's middle."""
    return float((part.origin + (ring.level - part.origin @ part.axis) * part.axis)[1]) / MM_TO_M
