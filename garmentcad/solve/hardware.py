"""Pins and buttons of a pattern on its cloth: as rows of constraints, and the refusal of those that contradict each other; and buttons with their shanks.

Buttons close as constraints, and then stand on a shank. What a constraint that contact holds open pulls with depends on the time step, and a garment that
is closed by it has no shape of rest but one for each step.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.cloth.locate import Anchors, anchors
from garmentcad.constraints.conflict import Dependence, dependences
from garmentcad.constraints.points import PointRows, rows_where
from garmentcad.contact.body import kept_gap
from garmentcad.contact.elements import LEAST_GAP, largest_around
from garmentcad.errors import SpecError, did_you_mean
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.button import Shanks, tilts
from garmentcad.forces.time_step import DAMPING_RATIO
from garmentcad.geometry.closest import closest_face
from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Panel, PanelPoint, Pattern, Pin
from garmentcad.units import M_TO_MM, MM_TO_M

SHANK_M = 1e-3  # thread of a button beyond the thickness of the cloth that it goes through; an estimate
# Beside a shank and at its end: 3 N move the hole by a tenth of a millimetre. Thread is many times stiffer (a dozen strands of some 100 N per unit of
# strain); an explicit step could not follow it. Damped at its own frequency as cloth is at its highest.
SHANK_N_M = 3e4
_AROUND = 3  # body vertices next to a point, as many as a face has
_INSIDE_MM = 0.1


class _PinRow(NamedTuple):
    """Where a pin holds the cloth, the nodes of the body that it is tied to with their weights in the row, and its target."""

    at: Anchors
    nodes: np.ndarray
    weights: np.ndarray
    target: np.ndarray


class _Foot(NamedTuple):
    """A point of the body: three nodes and their weights, the normal of their face, what leads from there to where the pin wants to be, and vertices around."""

    nodes: np.ndarray
    weights: np.ndarray
    normal: np.ndarray
    above: np.ndarray
    around: np.ndarray


def hardware_rows(pattern: Pattern, cloth: Cloth, materials: MaterialTable, body: Mannequin) -> PointRows:
    """A row for each pin and each button. The body's vertices are numbered after the particles. SpecError for landmarks that the body does not have, for
    points outside their panel, and for constraints that cannot all be met, with their names."""
    pins = _pin_rows(pattern, cloth, materials, body)
    entries = [(np.concatenate([at.particles, nodes]), np.concatenate([at.weights, weights]), target) for at, nodes, weights, target in pins]
    shanks = button_shanks(pattern, cloth, materials)
    for ends, weights in zip(shanks.particles, shanks.weights, strict=True):
        entries.append((ends.ravel(), (weights * [[-1.0], [1.0]]).ravel(), np.zeros(3)))
    names = (*(pin.name for pin in pattern.pins), *(button.name for button in pattern.buttons))
    size = len(entries)
    rows = PointRows(
        np.repeat(np.arange(size), [len(nodes) for nodes, _, _ in entries]),
        np.concatenate([np.empty(0, np.int64), *(nodes for nodes, _, _ in entries)]),
        np.concatenate([np.empty(0), *(weights for _, weights, _ in entries)]),
        np.array([target for _, _, target in entries]).reshape(-1, 3),
        names,
        np.concatenate([np.zeros(len(pins)), shanks.length]),
        np.array([*np.zeros(len(pins)), *(button.order for button in pattern.buttons)]),
    )
    held = {
        pin.name: target - product(weights, body.vertices[nodes - cloth.particle_count])
        for pin, (_, nodes, weights, target) in zip(pattern.pins, pins, strict=True)
    }
    for found in dependences(rows, cloth.particle_count, body.vertices):
        if found.conflicting:
            message = f"{_named(found)} contradict each other: they are {M_TO_MM * found.off_m:.1f} mm away from holding together"
            raise SpecError(message, key=_key(pattern, found.names[-1]))
    _refuse_out_of_reach(pattern, materials, held)
    return rows


def pin_rows(rows: PointRows) -> PointRows:
    """Those of the rows that stay constraints on a garment that is done up."""
    return rows_where(rows, rows.shank == 0.0)


def button_shanks(pattern: Pattern, cloth: Cloth, materials: MaterialTable) -> Shanks:
    """The buttons of a pattern, with shanks as long as the cloth at both ends is thick, and a little more."""
    thickness = largest_around(cloth, materials.thickness)
    ends = [[_anchor(cloth, end) for end in (button.button, button.buttonhole)] for button in pattern.buttons]
    particles = indices(np.array([[at.particles for at in both] for both in ends]).reshape(-1, 2, 3))
    weights = floats(np.array([[at.weights for at in both] for both in ends]).reshape(-1, 2, 3))
    length = np.maximum(thickness[particles].max(axis=(1, 2), initial=0.0), LEAST_GAP) + SHANK_M
    moves = weights**2
    moves[:, 0] += (length[:, None] * tilts(_at_rest(cloth, pattern, particles[:, 0]))) ** 2
    mobility = (moves / cloth.masses[particles]).sum(axis=(1, 2))
    return Shanks(particles, weights, length, np.full(len(length), SHANK_N_M), 2.0 * DAMPING_RATIO * np.sqrt(SHANK_N_M / mobility))


def _at_rest(cloth: Cloth, pattern: Pattern, particles: np.ndarray) -> np.ndarray:
    """The triangles (B,3,3) m below the buttons, as they are cut; their particles (B,3)."""
    corners = np.zeros((len(particles), 3, 3))
    for number, button in enumerate(pattern.buttons):
        mine = np.flatnonzero(cloth.vertex_panel == cloth.panel_names.index(button.button.panel))
        vertex = dict(zip(cloth.vertex_particle[mine].tolist(), mine.tolist(), strict=True))
        corners[number, :, :2] = MM_TO_M * cloth.vertex_uv_mm[[vertex[k] for k in particles[number].tolist()]]
    return corners


def redundances(rows: PointRows, cloth: Cloth, body: Mannequin) -> list[Dependence]:
    """Constraints that others imply already; they are solved all the same, by least squares."""
    return dependences(rows, cloth.particle_count, body.vertices)


def redundance_message(found: Dependence) -> str:
    """What the report and the doctor say of one."""
    if len(found.names) == 1:
        return f"button and buttonhole of '{found.names[0]}' are one point once the seams are closed: it holds nothing"
    return f"{_named(found)} hold the same points: one of them is redundant"


def _named(found: Dependence) -> str:
    names = [f"'{name}'" for name in found.names]
    return f"constraints {', '.join(names[:-1])} and {names[-1]}"


def _key(pattern: Pattern, name: str) -> str:
    return f"pins.{name}" if any(pin.name == name for pin in pattern.pins) else f"closures.{name}"


def _anchor(cloth: Cloth, point: PanelPoint) -> Anchors:
    found = anchors(cloth, point.panel, np.array([point.uv_mm]))
    return Anchors(found.particles[0], found.weights[0])


def _pin_rows(pattern: Pattern, cloth: Cloth, materials: MaterialTable, body: Mannequin) -> list[_PinRow]:
    held = [_anchor(cloth, pin.at) for pin in pattern.pins]
    feet = [None if pin.landmark is None else _foot(pin, body) for pin in pattern.pins]
    nearest = np.zeros((cloth.particle_count, _AROUND), dtype=np.int64)
    for at, foot in zip(held, feet, strict=True):
        if foot is not None:
            nearest[at.particles] = foot.around
    gap = kept_gap(cloth, materials, body.vertices, body.faces, nearest) if any(foot is not None for foot in feet) else np.zeros(cloth.particle_count)
    rows = []
    for pin, at, foot in zip(pattern.pins, held, feet, strict=True):
        if foot is None:
            rows.append(_PinRow(at, np.empty(0, np.int64), np.empty(0), MM_TO_M * np.array(pin.offset_mm)))
            continue
        clear = float(gap[at.particles].max())
        target = foot.above if product(foot.above, foot.normal) > clear else clear * foot.normal
        rows.append(_PinRow(at, cloth.particle_count + foot.nodes, -foot.weights, target))
    return rows


def _foot(pin: Pin, body: Mannequin) -> _Foot:
    """The point of the body below a pin."""
    if pin.landmark not in body.landmarks:
        hint = did_you_mean(str(pin.landmark), body.landmarks)
        raise SpecError(f"mannequin {body.name} has no landmark {pin.landmark!r}{hint}", key=f"pins.{pin.name}.landmark")
    wanted = np.asarray(body.landmarks[pin.landmark]) + MM_TO_M * np.array(pin.offset_mm)
    face, *shares = closest_face(wanted, body.vertices, body.faces)
    nodes, weights = body.faces[face].astype(np.int64), np.array(shares)
    a, b, c = body.vertices[nodes]
    closest, normal = product(weights, body.vertices[nodes]), np.cross(b - a, c - a)
    around = cKDTree(body.vertices).query(closest, k=_AROUND)[1]
    return _Foot(nodes, weights, normal / norm(normal), wanted - closest, around)


def _refuse_out_of_reach(pattern: Pattern, materials: MaterialTable, targets: dict[str, np.ndarray]) -> None:
    """Two pins of a panel are no farther apart than the yarns between them reach at their strain limit, first along one direction and then along the other."""
    longest = 1.0 + materials.strain_limit.max(axis=0)
    for a, b in combinations(pattern.pins, 2):
        if a.at.panel != b.at.panel:
            continue
        panel = pattern.panels[a.at.panel]
        warp = np.radians(panel.grain_deg)
        du, dv = np.array(b.at.uv_mm) - np.array(a.at.uv_mm)
        reach = abs(-np.sin(warp) * du + np.cos(warp) * dv) * longest[WARP] + abs(np.cos(warp) * du + np.sin(warp) * dv) * longest[WEFT]
        apart = M_TO_MM * norm(targets[a.name] - targets[b.name])
        if apart > reach + 1.0 and _whole_between(panel, a, b):
            message = f"pins '{a.name}' and '{b.name}' contradict each other: they are {apart:.0f} mm apart, and the cloth between them reaches {reach:.0f} mm"
            raise SpecError(message, key=f"pins.{b.name}")


def _whole_between(panel: Panel, a: Pin, b: Pin) -> bool:
    """Whether the straight line between two pins lies on the panel."""
    loops = [np.vstack([edge.curve.polyline(1.0)[:-1] for edge in loop]) for loop in (panel.edges, *panel.holes)]
    return bool(shapely.Polygon(loops[0], loops[1:]).buffer(_INSIDE_MM).covers(shapely.LineString([a.at.uv_mm, b.at.uv_mm])))
