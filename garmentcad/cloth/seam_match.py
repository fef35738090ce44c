"""Which places along the two sides of a seam meet: samples at equal fractions of arc length between marks that both sides have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from garmentcad.errors import SpecError
from garmentcad.pattern.pattern import EdgeUse, Panel, Seam
from garmentcad.pattern.runs import side_notches

_MERGE_MM = 1.0  # marks on the two sides that meet this closely are sewn to each other


@dataclass(frozen=True)
class SeamMatch:
    """count: samples along the seam, both ends included. joints_a (len(a)+1,): the sample at which each edge use starts, and the last sample.
    fractions_a: for each use the arc-length fractions along its edge in OUTLINE order, 0 and 1 included. Side b alike."""

    count: int
    joints_a: np.ndarray
    joints_b: np.ndarray
    fractions_a: tuple[np.ndarray, ...]
    fractions_b: tuple[np.ndarray, ...]


class _Side(NamedTuple):
    joints: np.ndarray  # (n+1,) mm along the run: ends of its edges, 0 and the length included
    notches: dict[str, float]  # mm along the run


class _Mark(NamedTuple):
    a: float
    b: float
    vertex_a: bool  # an outline vertex of side a
    vertex_b: bool
    paired: bool  # both places are given: a notch, an end, or a vertex sewn to one


def match_seam(seam: Seam, panels: dict[str, Panel], grid_mm: float, given: Sequence[np.ndarray] | None = None) -> SeamMatch:
    """Samples of both sides of a seam.

    Notches of the same name on both sides meet, and so do the ends; between them the sides meet at equal fractions of arc length. Every outline vertex
    inside either run is a sample; one that lies within 1 mm of a vertex or notch of the other side is sewn to it. Between samples so found, as many equal
    parts as keep both sides within the grid. Raises SpecError for uses that do not exist, notch names that a side has twice, and notches whose order differs.

    given: for each use of side a the fractions that another seam has chosen; they stay, and side b, a third layer there, follows. SpecError where a corner or
    notch of b meets none of them.
    """
    a, b = (_side(seam, uses, panels) for uses in (seam.a, seam.b))
    marks = _marks(seam, a, b)
    along_a, along_b = (np.array([getattr(mark, name) for mark in marks]) for name in ("a", "b"))
    if given is not None:
        positions_a = _positions(seam.a, a.joints, given)
        along_a = _onto(along_a, positions_a, seam)
        return _matched(seam, a, b, positions_a, np.interp(positions_a, along_a, along_b))
    parts = [part_count(max(da, db), grid_mm) for da, db in zip(np.diff(along_a), np.diff(along_b))]
    if seam.tack is not None and len(parts) == 1:
        parts = [max(2, parts[0])]  # one edge would lie on that of the cloth over which the pleat is caught, as a third layer
    return _matched(seam, a, b, _fill(along_a, parts), _fill(along_b, parts))


def _matched(seam: Seam, a: _Side, b: _Side, positions_a: np.ndarray, positions_b: np.ndarray) -> SeamMatch:
    joints_a, joints_b = np.searchsorted(positions_a, a.joints), np.searchsorted(positions_b, b.joints)
    return SeamMatch(
        len(positions_a), joints_a, joints_b, _fractions(seam.a, a.joints, joints_a, positions_a), _fractions(seam.b, b.joints, joints_b, positions_b)
    )


def _positions(uses: tuple[EdgeUse, ...], joints_mm: np.ndarray, fractions: Sequence[np.ndarray]) -> np.ndarray:
    """Samples along a run, mm, from the fractions of its edges; the joints to the bit."""
    pieces = []
    for k, use in enumerate(uses):
        along = 1.0 - fractions[k][::-1] if use.reverse else fractions[k]
        piece = joints_mm[k] + along * (joints_mm[k + 1] - joints_mm[k])
        piece[0], piece[-1] = joints_mm[k], joints_mm[k + 1]
        pieces.append(piece[:-1])
    return np.append(np.concatenate(pieces), joints_mm[-1])


def _onto(along: np.ndarray, positions: np.ndarray, seam: Seam) -> np.ndarray:
    """The samples at which marks along side a stand."""
    nearest = positions[np.abs(along[:, None] - positions[None, :]).argmin(axis=1)]
    off = np.abs(nearest - along)
    if off.max() > _MERGE_MM or len(np.unique(nearest)) < len(nearest):
        where = along[int(off.argmax())]
        text = f"a corner or notch {where:.1f} mm along side a meets no stitch of seam {seam.caught_in}; layers that are caught in one seam have corners alike"
        raise SpecError(text, key=f"seams.{seam.name}")
    return nearest


def part_count(length_mm: float, grid_mm: float) -> int:
    """Number of equal parts, each no longer than the grid up to round-off."""
    return max(1, math.ceil(length_mm / grid_mm - 1e-6))


def _side(seam: Seam, uses: tuple[EdgeUse, ...], panels: dict[str, Panel]) -> _Side:
    key = f"seams.{seam.name}"
    if not uses:
        raise SpecError("a side has no edges", key=key)
    joints, notches = [0.0], dict[str, float]()
    for use in uses:
        if use.panel not in panels or not 0 <= use.edge < len(panels[use.panel].edges):
            raise SpecError(f"no edge {use.edge} of panel {use.panel!r}", key=key)
        joints.append(joints[-1] + panels[use.panel].edges[use.edge].curve.length)
    for name, place in side_notches(panels, uses):
        if name in notches:
            raise SpecError(f"two notches named {name!r} on one side; a seam pairs notches by name", key=key)
        notches[name] = place
    return _Side(np.array(joints), notches)


def _marks(seam: Seam, a: _Side, b: _Side) -> list[_Mark]:
    """Places that must be samples, in order, both ends included."""
    shared = sorted((a.notches[name], b.notches[name], name) for name in a.notches.keys() & b.notches.keys())
    shared = [notch for notch in shared if not _at_end(notch, a, b)]
    anchors_a = np.array([0.0, *(notch[0] for notch in shared), a.joints[-1]])
    anchors_b = np.array([0.0, *(notch[1] for notch in shared), b.joints[-1]])
    if np.any(np.diff(anchors_a) <= 0.0) or np.any(np.diff(anchors_b) <= 0.0):
        names = ", ".join(notch[2] for notch in shared)
        raise SpecError(f"notches {names} (in order along side a) come in another order along side b; is the seam turned round?", key=f"seams.{seam.name}")
    inner_a, inner_b = a.joints[1:-1], b.joints[1:-1]
    marks = [_Mark(notch[0], notch[1], False, False, True) for notch in shared]
    marks += [_Mark(*pair, True, False, False) for pair in zip(inner_a.tolist(), np.interp(inner_a, anchors_a, anchors_b).tolist())]
    marks += [_Mark(*pair, False, True, False) for pair in zip(np.interp(inner_b, anchors_b, anchors_a).tolist(), inner_b.tolist())]
    merged = [_Mark(0.0, 0.0, True, True, True)]
    for mark in [*sorted(marks, key=lambda mark: (mark.a + mark.b, mark)), _Mark(a.joints[-1], b.joints[-1], True, True, True)]:
        last = merged[-1]
        near = mark.a - last.a < _MERGE_MM and mark.b - last.b < _MERGE_MM
        if near and not (mark.vertex_a and last.vertex_a) and not (mark.vertex_b and last.vertex_b):
            at_a = mark.a if mark.vertex_a else last.a
            at_b = mark.b if mark.vertex_b else last.b
            merged[-1] = _Mark(at_a, at_b, mark.vertex_a or last.vertex_a, mark.vertex_b or last.vertex_b, True)
        else:
            merged.append(mark)
    # Merging moved some marks by up to 1 mm: the others meet where they do between the pairs that both sides now have.
    pairs = [mark for mark in merged if mark.paired]
    pairs_a, pairs_b = ([getattr(mark, name) for mark in pairs] for name in ("a", "b"))
    settled = []
    for mark in merged:
        if not mark.paired and mark.vertex_a:
            mark = mark._replace(b=float(np.interp(mark.a, pairs_a, pairs_b)))
        elif not mark.paired:
            mark = mark._replace(a=float(np.interp(mark.b, pairs_b, pairs_a)))
        settled.append(mark)
    settled.sort()
    for last, mark in pairwise(settled):
        if mark.a <= last.a or mark.b <= last.b:
            raise SpecError(f"corners and notches {last.a:.1f} to {mark.a:.1f} mm along side a cannot be paired with side b", key=f"seams.{seam.name}")
    return settled


def _at_end(notch: tuple[float, float, str], a: _Side, b: _Side) -> bool:
    """Whether a notch stands at the same end of both sides, where a sample is anyway."""
    return max(notch[0], notch[1]) <= _MERGE_MM or max(a.joints[-1] - notch[0], b.joints[-1] - notch[1]) <= _MERGE_MM


def _fill(along: np.ndarray, parts: list[int]) -> np.ndarray:
    """Positions along a run: each interval between marks cut into its number of equal parts; the marks themselves to the bit."""
    pieces = [np.linspace(along[k], along[k + 1], count + 1)[:-1] for k, count in enumerate(parts)]
    return np.append(np.concatenate(pieces), along[-1])


def _fractions(uses: tuple[EdgeUse, ...], joints_mm: np.ndarray, joints: np.ndarray, positions: np.ndarray) -> tuple[np.ndarray, ...]:
    found = []
    for k, use in enumerate(uses):
        inside = positions[joints[k] : joints[k + 1] + 1] - joints_mm[k]
        fractions = inside / (joints_mm[k + 1] - joints_mm[k])
        fractions[-1] = 1.0
        found.append(1.0 - fractions[::-1] if use.reverse else fractions)
    return tuple(found)
