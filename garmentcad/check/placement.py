"""Findings on placed panels: twisted seams, seams that cross over, panels that cross each other, panels inside the mannequin or far from it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from garmentcad.analysis.clearance import Move
from garmentcad.analysis.inside import SHALLOW_M, place_inside, remedy_inside
from garmentcad.analysis.penetration import signed_distances
from garmentcad.check.finding import Finding
from garmentcad.check.one_sided import alike, seams_turned_over
from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.intersection import crossing_owners, crossing_triangle_pairs
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import EdgeUse, Pattern, Seam, Wrap
from garmentcad.pattern.runs import side_length
from garmentcad.units import M_TO_MM, MM_TO_M

_FAR_M = 1.0  # panels of GarmentCode start up to half a metre away
_CROSSED = -0.8  # cosine between ways that go against each other: from one seam to the other along both of their sides, and along both sides of one seam
_APART_M = 0.050  # seams nearer to each other say nothing
_MEANT = 1.1  # seams that cross over and are no longer for it than this are meant to, as straps that cross behind the back
_STRAIGHT = 0.7  # of the length of a side, between its ends


def check_moves(moves: list[Move], file: str | None = None) -> Iterator[Finding]:
    """Panels that a run moves before it starts, because they touch something as placed."""
    for move in moves:
        yield Finding(
            "note", "panel-moved", file, f"panels.{move.panel}.placement", str(move),
            "It is moved before the run starts; change its placement, if it shall start elsewhere.",
        )  # fmt: skip


def check_placement(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, file: str | None = None) -> Iterator[Finding]:
    """Collisions of the start positions (V,3) m of an unsewn cloth: panel against panel, and panel against body."""
    depth = -signed_distances(positions, mannequin.vertices, mannequin.faces)
    for index, name in enumerate(cloth.panel_names):
        mine = cloth.vertex_panel == index
        inside = mine & (depth > 0.0)
        if inside.any():
            deepest, remedy = float(depth[inside].max()), remedy_inside(positions[inside], mannequin)
            yield Finding(
                "error" if deepest > SHALLOW_M else "warning", "panel-inside-body", file, f"panels.{name}.placement",
                f"{int(inside.sum())} of {int(mine.sum())} points start inside {mannequin.name}, up to {max(deepest * M_TO_MM, 1.0):.0f} mm deep, "
                f"{place_inside(positions[inside], mannequin)}",
                f"{remedy[0].upper()}{remedy[1:]}; points less than {SHALLOW_M * M_TO_MM:.0f} mm deep are moved out before the start.",
            )  # fmt: skip
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    others = crossing_owners(positions, cloth.triangles, owner)
    for index, name in enumerate(cloth.panel_names):
        place = f"panels.{name}.placement"
        own = len(crossing_triangle_pairs(positions, cloth.triangles[owner == index]))
        if own > 0:
            yield Finding(
                "error", "placement-crossing", file, place, f"as placed the panel crosses itself in {own} pairs of triangles",
                "Wrap it wider: enlarge offset or scale.",
            )  # fmt: skip
        for other, count in ((cloth.panel_names[b], count) for (a, b), count in others.items() if a == index):
            yield Finding(
                "error", "placement-crossing", file, place, f"as placed the panel crosses panel {other} in {count} or more pairs of triangles",
                "Move the placements apart: other angles, heights or offsets.",
            )  # fmt: skip


def check_reach(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, file: str | None = None) -> Iterator[Finding]:
    """Wrapped panels that lie wholly above or below the part of the body that they are wrapped around: a height in cm, say. What is wrapped around the torso
    may hang beside all that is below it, as the tiers of a skirt do."""
    for index, (name, panel) in enumerate(pattern.panels.items()):
        rule = panel.placement
        if not isinstance(rule, Wrap) or rule.part not in mannequin.part_names:
            continue
        cylinder, part = mannequin.cylinders[rule.part], mannequin.face_part == mannequin.part_names.index(rule.part)
        along = M_TO_MM * ((positions[cloth.vertex_panel == index] - cylinder.origin) @ cylinder.up)
        heights = M_TO_MM * ((mannequin.vertices - cylinder.origin) @ cylinder.up)
        body = heights[np.unique(mannequin.faces[part])]
        lowest = (heights if rule.part == "torso" else body).min(initial=np.inf)
        if len(body) and (along.max() < lowest or along.min() > body.max()):
            yield Finding(
                "error", "placement-off-body", file, f"panels.{name}.placement.wrap.height",
                f"the panel is wrapped from {along.min():.0f} to {along.max():.0f} mm along '{rule.part}', "
                f"which goes from {body.min():.0f} to {body.max():.0f} mm",
                "Heights are in mm along the part, those of the torso above the floor; correct the height, or name the part that is meant.",
            )  # fmt: skip


def check_far(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, file: str | None = None) -> Iterator[Finding]:
    """Panels that start far from the body or below the floor: a translation, or a height above the floor, in cm, say."""
    low, high = mannequin.vertices.min(axis=0), mannequin.vertices.max(axis=0)
    for index, (name, panel) in enumerate(pattern.panels.items()):
        wrapped, mine = isinstance(panel.placement, Wrap), positions[cloth.vertex_panel == index]
        below, beside = ("wrap.height", "wrap.offset") if wrapped else ("transform.translation", "transform.translation")
        how = "Heights and offsets are in mm" if wrapped else "Translations are in mm, y is the height above the floor"
        away = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - mine, mine - high)), axis=1).min())
        middle = M_TO_MM * float(mine[:, 1].mean())
        if middle < 0.0:
            yield Finding(
                "warning", "panel-below-floor", file, f"panels.{name}.placement.{below}", f"the middle of the panel starts {-middle:.0f} mm below the floor",
                f"{how}; lay the panel beside the part of the body that wears it.",
            )  # fmt: skip
        elif away > _FAR_M:
            yield Finding(
                "warning", "panel-far", file, f"panels.{name}.placement.{beside}", f"the panel starts {away * M_TO_MM:.0f} mm away from {mannequin.name}",
                f"{how}; lay the panel beside the part of the body that wears it.",
            )  # fmt: skip


def check_twists(pattern: Pattern, cloth: Cloth, positions: np.ndarray, file: str | None = None) -> Iterator[Finding]:
    """Seams whose sides lie the other way round in space: with one side turned around, both pairs of points would be closer.

    The points at a quarter and three quarters of each side are compared, because the ends of a ring lie in one place. Darts cannot twist. Where distances say
    nothing, a seam counts that turns the cloth over (one_sided.py).
    """
    over = set(seams_turned_over(pattern))
    for seam in pattern.seams:
        if any(pattern.panels[use.panel].edges[use.edge].dart for use in (*seam.a, *seam.b)):
            continue
        first_a, last_a, first_b, last_b = _at(pattern, cloth, positions, seam, 0.25, 0.75)
        straight = np.linalg.norm(first_a - first_b), np.linalg.norm(last_a - last_b)
        swapped = np.linalg.norm(first_a - last_b), np.linalg.norm(last_a - first_b)
        remedy = "Swap the first and last point of one side, or correct the placement of its panel."
        # A hair's breadth is no twist: points that are equally far say nothing.
        if swapped[0] + MM_TO_M < straight[0] and swapped[1] + MM_TO_M < straight[1]:
            yield Finding(
                "error", "seam-twisted", file, f"seams.{seam.name}",
                f"as placed, a quarter and three quarters along the seam its sides are {straight[0] * M_TO_MM:.0f} and {straight[1] * M_TO_MM:.0f} mm apart; "
                f"with one side turned around they would be {swapped[0] * M_TO_MM:.0f} and {swapped[1] * M_TO_MM:.0f} mm apart",
                remedy,
            )  # fmt: skip
        elif _opposite(pattern, cloth, positions, seam):
            text = "as placed, its sides go opposite ways from their first points to their last"
            yield Finding("error", "seam-twisted", file, f"seams.{seam.name}", text, remedy)
        elif seam.name in over:
            text = "sewn so, the right side of the cloth goes over into its wrong side: the other seams of its panels lay both the same way up"
            yield Finding("error", "seam-twisted", file, f"seams.{seam.name}", text, remedy)


def _opposite(pattern: Pattern, cloth: Cloth, positions: np.ndarray, seam: Seam) -> bool:
    """Whether both sides lie nearly straight and go opposite ways. Where they are short and far apart (the ends of a waistband, a strap and the band that it is
    sewn to) distances are nearly alike: what counts is how far apart points are along the seam."""
    first_a, last_a, first_b, last_b = _at(pattern, cloth, positions, seam, 0.0, 1.0)
    ways = last_a - first_a, last_b - first_b
    lengths = [float(np.linalg.norm(way)) for way in ways]
    if any(length <= _STRAIGHT * MM_TO_M * side_length(pattern, side) for length, side in zip(lengths, (seam.a, seam.b))):
        return False  # of a ring, whose ends lie in one place, they say nothing
    along = ways[0] / lengths[0]
    nearer = abs((first_a - last_b) @ along) < abs((first_a - first_b) @ along) and abs((last_a - first_b) @ along) < abs((last_a - last_b) @ along)
    return bool(nearer and ways[0] @ ways[1] < _CROSSED * lengths[0] * lengths[1])


def _at(pattern: Pattern, cloth: Cloth, positions: np.ndarray, seam: Seam, first: float, last: float) -> list[np.ndarray]:
    """Places (3,) at two fractions of side a, then of side b."""
    return [_placed(pattern, cloth, positions, side, at) for side in (seam.a, seam.b) for at in (first, last)]


def check_crossed(pattern: Pattern, cloth: Cloth, positions: np.ndarray, file: str | None = None) -> Iterator[Finding]:
    """Two seams of one panel that cross over as placed, at (V,3) m: from the middle of the first to that of the second its partners lie the other way.

    Where partners meet, as beside a godet, the middles of the panels count, and only for seams that run along both outlines alike: sewn so, what is let in
    would lie on its face. A lining or a facing is sewn alike too, but its partners do not lie the other way.
    """
    middles, over = [], {seam.name for seam in pattern.seams if alike(seam) and seam.caught_in is None}
    panel_middles = {name: positions[cloth.vertex_panel == index].mean(axis=0) for index, name in enumerate(cloth.panel_names)}
    for seam in pattern.seams:
        if all(len({use.panel for use in side}) == 1 for side in (seam.a, seam.b)) and seam.a[0].panel != seam.b[0].panel:
            middles.append((seam.name, {side[0].panel: _placed(pattern, cloth, positions, side, 0.5) for side in (seam.a, seam.b)}))
    for (one, first), (two, second) in combinations(middles, 2):
        shared = next((name for name in first if name in second), None)
        if shared is None:
            continue
        (partner, a), (other, b) = (next((name, place) for name, place in sides.items() if name != shared) for sides in (first, second))
        along, across = second[shared] - first[shared], b - a
        meet = np.linalg.norm(across) <= _APART_M
        if meet and over.issuperset((one, two)):
            across = panel_middles[other] - panel_middles[partner]
        lengths = float(np.linalg.norm(along)), float(np.linalg.norm(across))
        if min(lengths) > _APART_M and along @ across < _CROSSED * lengths[0] * lengths[1]:
            given = np.linalg.norm(first[shared] - a), np.linalg.norm(second[shared] - b)
            swapped = np.linalg.norm(first[shared] - b), np.linalg.norm(second[shared] - a)
            if not meet and sum(given) < _MEANT * sum(swapped):
                continue
            yield Finding(
                "warning", "seams-cross-over", file, f"seams.{one}",
                f"as placed, seams {one} and {two} cross over: they join {shared} to {' and '.join(dict.fromkeys((partner, other)))} over "
                f"{given[0] * M_TO_MM:.0f} and {given[1] * M_TO_MM:.0f} mm (from middle to middle); with partners swapped it would be "
                f"{swapped[0] * M_TO_MM:.0f} and {swapped[1] * M_TO_MM:.0f} mm. One panel probably lies wrong side out, or is mirrored",
                "Turn what lies behind the body so that its right side looks outward (`rotation: [0, 180, 0]`, or a wrap at the angle 180), "
                "or swap the partners of the seams.",
            )  # fmt: skip


def _placed(pattern: Pattern, cloth: Cloth, positions: np.ndarray, side: tuple[EdgeUse, ...], at: float) -> np.ndarray:
    """Position (3,) of the contour particle nearest to a fraction of a side's length."""
    target, done = at * side_length(pattern, side), 0.0
    for use in side:
        curve = pattern.panels[use.panel].edges[use.edge].curve
        if done + curve.length >= target - 1e-9 or use is side[-1]:
            inside = min(1.0, max(0.0, (target - done) / max(curve.length, 1e-12)))
            break
        done += curve.length
    place = curve.points_at(1.0 - inside if use.reverse else inside)[0]
    chosen = np.flatnonzero((cloth.vertex_panel == cloth.panel_names.index(use.panel)) & cloth.vertex_on_contour)
    nearest = chosen[np.argmin(np.hypot(*(cloth.vertex_uv_mm[chosen] - place).T))]
    return positions[nearest]
