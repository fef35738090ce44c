"""Contours: outlines, holes and fold lines of all panels as points no farther apart than the grid. Millimetres."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from garmentcad.arrays import indices
from garmentcad.cloth.fold_chains import fold_chains
from garmentcad.cloth.seam_match import SeamMatch, match_seam, part_count
from garmentcad.errors import SpecError
from garmentcad.geometry.polygon import crossing_point, signed_area
from garmentcad.pattern.pattern import Edge, EdgeUse, Panel, Pattern, Seam

_JOIN_MM = 0.01  # edges of a loop meet within this, and points of a contour lie farther apart than this


@dataclass(frozen=True)
class Contour:
    """Sampled outline, holes and fold lines of one panel.

    points_mm (N,2): loop after loop, each with the panel on its left, then what fold lines have between their ends; loop_start (K+1,): compressed rows, the
    outline first; edge_points: for each edge (outline, then holes, in order) its points with both ends, indices into points_mm;
    sewn (loop_start[-1],) bool: whether a seam runs over the segment that starts at the point; chains: number of a fold and its points in order, more than one
    chain where the fold leaves the panel.
    """

    points_mm: np.ndarray
    loop_start: np.ndarray
    edge_points: tuple[np.ndarray, ...]
    sewn: np.ndarray
    chains: tuple[tuple[int, np.ndarray], ...] = ()

    @cached_property
    def segments(self) -> np.ndarray:
        """(N,2) int32: each point of a loop and the next one."""
        after = np.arange(1, self.loop_start[-1] + 1)
        after[self.loop_start[1:] - 1] = self.loop_start[:-1]
        return indices(np.stack([np.arange(len(after)), after], axis=1))

    @cached_property
    def fold_segments(self) -> tuple[np.ndarray, np.ndarray]:
        """(F,2) int32: neighbours on fold lines; and the fold of each (F,)."""
        pairs = [np.stack([chain[:-1], chain[1:]], axis=1) for _, chain in self.chains]
        numbers = np.repeat([number for number, _ in self.chains], [len(pair) for pair in pairs])
        return indices(np.concatenate([np.empty((0, 2)), *pairs])), indices(numbers)

    @property
    def walls(self) -> np.ndarray:
        """(N+F,2) int32: what no cell reaches across, loops and then folds."""
        return np.concatenate([self.segments, self.fold_segments[0]])

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The region between the sampled outline and the sampled holes."""
        loops = [self.points_mm[a:b] for a, b in zip(self.loop_start[:-1], self.loop_start[1:])]
        return shapely.Polygon(loops[0], loops[1:])


def sample_contours(pattern: Pattern, grid_mm: float) -> tuple[dict[str, Contour], list[np.ndarray]]:
    """Contours by panel name, and for each seam its stitches (S,4) int32 in order: panel number, point, panel number, point (side a, side b).

    A point stands at every vertex of an outline; between them edges are split into equal parts no longer than `grid_mm`. The two sides of a seam
    get the same number of points (see `match_seam`). Raises SpecError for loops that are open, run the wrong way round or cross themselves, and for
    seams that name an edge twice or do not exist.
    """
    for panel in pattern.panels.values():
        _check_lengths(panel)
    fractions: dict[tuple[str, int], np.ndarray] = {}
    owner: dict[tuple[str, int], str] = {}
    matches: dict[str, SeamMatch] = {}
    for seam in sorted(pattern.seams, key=lambda seam: seam.caught_in is not None):
        given = None
        if seam.caught_in is not None:
            given = [fractions[use.panel, use.edge] for use in seam.a if owner.get((use.panel, use.edge)) == seam.caught_in]
            if len(given) < len(seam.a):
                raise SpecError(f"side a is caught in {seam.caught_in}, but not all of its edges are sewn there", key=f"seams.{seam.name}")
        match = matches[seam.name] = match_seam(seam, pattern.panels, grid_mm, given)
        fresh = zip(seam.b, match.fractions_b) if given is not None else (*zip(seam.a, match.fractions_a), *zip(seam.b, match.fractions_b))
        for use, values in fresh:
            place = (use.panel, use.edge)
            if place in owner:
                name = pattern.panels[use.panel].edges[use.edge].name
                raise SpecError(
                    f"edge {use.panel}.{name} is sewn in {owner[place]} and in {seam.name}; an edge belongs to one seam, but for a layer that is caught_in it",
                    key=f"seams.{seam.name}",
                )
            owner[place] = seam.name
            fractions[place] = values
    contours = {name: _sample_panel(panel, fractions, grid_mm) for name, panel in pattern.panels.items()}
    number = {name: index for index, name in enumerate(pattern.panels)}
    stitches = [_stitches(seam, matches[seam.name], contours, number) for seam in pattern.seams]
    for seam in pattern.seams:
        if seam.closed is not None:
            contours |= _opened(seam, matches[seam.name], contours)
    return contours, stitches


def _sample_panel(panel: Panel, sewn: dict[tuple[str, int], np.ndarray], grid_mm: float) -> Contour:
    points: list[np.ndarray] = []
    flags: list[np.ndarray] = []
    edge_points: list[np.ndarray] = []
    loop_start = [0]
    for loop_number, loop in enumerate((panel.edges, *panel.holes)):
        least = math.ceil(3 / len(loop))  # a loop is a polygon: three points at least
        first = count = loop_start[-1]
        for number, edge in enumerate(loop):
            _check_joint(panel, edge, loop[(number + 1) % len(loop)])
            values = sewn.get((panel.name, number)) if loop_number == 0 else None
            is_sewn = values is not None
            if values is None:
                values = np.linspace(0.0, 1.0, max(least, part_count(edge.curve.length, grid_mm)) + 1)
            flags.append(np.full(len(values) - 1, is_sewn))
            points.append(edge.curve.points_at(values)[:-1])
            edge_points.append(indices(np.arange(count, count + len(values))))
            count += len(values) - 1
        edge_points[-1][-1] = first
        loop_start.append(count)
    contour = Contour(np.concatenate(points), indices(loop_start), tuple(edge_points), np.concatenate(flags))
    _check_loops(panel, contour, grid_mm)
    inside, chains = fold_chains(panel.folds, contour.points_mm, contour.polygon, grid_mm)
    return replace(contour, points_mm=np.concatenate([contour.points_mm, inside]), chains=chains)


def _check_lengths(panel: Panel) -> None:
    for edge in (edge for loop in (panel.edges, *panel.holes) for edge in loop):
        if not (math.isfinite(edge.curve.length) and edge.curve.length > _JOIN_MM):
            text = f"edge {edge.name} has a length of {edge.curve.length:.3g} mm; edges must be finite and longer than {_JOIN_MM} mm"
            raise SpecError(text, key=f"panels.{panel.name}")


def _check_joint(panel: Panel, edge: Edge, after: Edge) -> None:
    gap = math.dist(edge.curve.end, after.curve.start)
    if gap > _JOIN_MM:
        raise SpecError(f"edge {edge.name} ends {gap:.3g} mm from the start of {after.name}; the edges of a loop must join", key=f"panels.{panel.name}")


def _check_loops(panel: Panel, contour: Contour, grid_mm: float) -> None:
    key = f"panels.{panel.name}"
    for number, (a, b) in enumerate(zip(contour.loop_start[:-1], contour.loop_start[1:])):
        loop, what = contour.points_mm[a:b], f"hole {number}" if number else "the outline"
        step = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
        if step.min() < _JOIN_MM:
            u, v = loop[int(step.argmin())]
            raise SpecError(f"{what} comes back onto itself within {step.min():.3g} mm near ({u:.1f}, {v:.1f}) mm", key=key)
        crossing = crossing_point(loop)
        if crossing is not None:
            text = f"{what}, sampled at {grid_mm:g} mm, crosses or touches itself near ({crossing[0]:.1f}, {crossing[1]:.1f}) mm"
            raise SpecError(f"{text}; correct it, or use a smaller grid", key=key)
        if (signed_area(loop) > 0.0) != (number == 0):
            raise SpecError(f"{what} runs {'clockwise' if number == 0 else 'counter-clockwise'}; outlines run counter-clockwise, holes clockwise", key=key)
    if not contour.polygon.is_valid:
        raise SpecError(f"a hole, sampled at {grid_mm:g} mm, meets the outline or another hole: {shapely.is_valid_reason(contour.polygon)}", key=key)


def _stitches(seam: Seam, match: SeamMatch, contours: dict[str, Contour], number: dict[str, int]) -> np.ndarray:
    """Stitches (S,4) along a seam, or along the closed part of a zip; last the tack of a pleat."""
    arriving_a, leaving_a = _run_points(seam.a, match.joints_a, match.count, contours, number)
    arriving_b, leaving_b = _run_points(seam.b, match.joints_b, match.count, contours, number)
    pairs = np.stack([np.hstack([arriving_a, arriving_b]), np.hstack([leaving_a, leaving_b])], axis=1).reshape(-1, 4)
    if seam.closed is not None:
        teeth = _teeth(seam, match, contours)
        pairs = pairs[: 2 * (teeth + 1) if teeth > 0 else 0]
    fresh = np.append(True, np.any(pairs[1:] != pairs[:-1], axis=1))
    apart = np.any(pairs[:, :2] != pairs[:, 2:], axis=1)  # the apex of a dart needs no stitch
    stitches = pairs[fresh & apart]
    if seam.tack is not None:
        onto = number[seam.tack.panel], contours[seam.tack.panel].edge_points[seam.tack.edge][0]
        stitches = np.vstack([stitches, [*arriving_a[-1], *onto]])
    return indices(stitches)


def _teeth(seam: Seam, match: SeamMatch, contours: dict[str, Contour]) -> int:
    """The sample up to which a zip is closed: the nearest one to its share of the length of side a."""
    assert seam.closed is not None
    lengths = np.concatenate([_steps(contours[use.panel], use) for use in seam.a])
    along = np.append(0.0, np.cumsum(lengths))
    return int(np.argmin(np.abs(along - seam.closed * along[-1])))


def _steps(contour: Contour, use: EdgeUse) -> np.ndarray:
    """Lengths, mm, from sample to sample along an edge as a seam runs over it."""
    steps = np.linalg.norm(np.diff(contour.points_mm[contour.edge_points[use.edge]], axis=0), axis=1)
    return steps[::-1] if use.reverse else steps


def _opened(seam: Seam, match: SeamMatch, contours: dict[str, Contour]) -> dict[str, Contour]:
    """The contours that a zip runs over, with its open part as outline to which nothing is sewn."""
    found, teeth = dict(contours), _teeth(seam, match, contours)
    for uses, joints in ((seam.a, match.joints_a), (seam.b, match.joints_b)):
        for use, first, last in zip(uses, joints[:-1], joints[1:]):
            contour = found[use.panel]
            closed = int(np.clip(teeth - first, 0, last - first))
            begins = contour.edge_points[use.edge][:-1]  # of segments, as the outline runs
            sewn = contour.sewn.copy()
            sewn[begins[: last - first - closed] if use.reverse else begins[closed:]] = False
            found[use.panel] = replace(contour, sewn=sewn)
    return found


def _run_points(
    uses: tuple[EdgeUse, ...], joints: np.ndarray, count: int, contours: dict[str, Contour], number: dict[str, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Panel number and point (count,2) of each sample of a run, as the end of the part before it and as the start of the part after it.

    The two differ where the run jumps: over the legs of a dart, or from panel to panel.
    """
    arriving, leaving = np.empty((count, 2), dtype=np.int64), np.empty((count, 2), dtype=np.int64)
    for k, use in enumerate(uses):
        points = contours[use.panel].edge_points[use.edge]
        points = points[::-1] if use.reverse else points
        a, b = joints[k], joints[k + 1]
        arriving[a + 1 : b + 1] = np.stack([np.full(b - a, number[use.panel]), points[1:]], axis=1)
        leaving[a:b] = np.stack([np.full(b - a, number[use.panel]), points[:-1]], axis=1)
    arriving[0], leaving[-1] = leaving[0], arriving[-1]
    return arriving, leaving
