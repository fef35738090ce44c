"""Findings on seams: lengths against the intended ease, edges sewn twice, notches that do not meet."""

from __future__ import annotations

from collections.abc import Iterator

from garmentcad.check.finding import Finding
from garmentcad.pattern.pattern import Pattern, Seam
from garmentcad.pattern.runs import side_length, side_notches

_ABSOLUTE_MM, _RELATIVE = 3.0, 0.02  # a seam may be off by the larger of the two
_NOTE_MM = 0.5
_DART_MM = 1.0
_FREE = ("hem", "cuff")  # roles of edges that are sewn to nothing


def check_seams(pattern: Pattern, file: str | None) -> Iterator[Finding]:
    """Everything that is wrong with the seams as they lie on the table (`check_placement` looks at them in space)."""
    owner: dict[tuple[str, int], str] = {}
    for seam in pattern.seams:
        yield from _check_dart(pattern, seam, file) if _is_dart(pattern, seam) else _check_length(pattern, seam, file)
        yield from _check_notches(pattern, seam, file)
        for use in seam.b if seam.caught_in is not None else (*seam.a, *seam.b):
            place = (use.panel, use.edge)
            if place in owner:
                edge = pattern.panels[use.panel].edges[use.edge]
                also = f"in seam {owner[place]} too" if owner[place] != seam.name else "twice in this seam"
                yield Finding(
                    "error", "edge-sewn-twice", file, f"seams.{seam.name}", f"edge {use.panel}.{edge.name} ({edge.start} to {edge.end}) is sewn {also}",
                    "An edge belongs to one seam: take it out of one of them, split the edge at a new point, or let a third layer be caught_in the seam.",
                )  # fmt: skip
            owner.setdefault(place, seam.name)
    yield from _check_roles(pattern, owner, file)


def _check_roles(pattern: Pattern, owner: dict[tuple[str, int], str], file: str | None) -> Iterator[Finding]:
    """Edges with the role of a free end that are sewn: a hem's height, range and folds would be measured along a seam. owner: seam of (panel, edge)."""
    for (name, number), seam in owner.items():
        edge = pattern.panels[name].edges[number]
        if edge.role in _FREE and edge.dart is None:
            yield Finding(
                "warning", "role-sewn", file, f"panels.{name}.edges.{edge.name}",
                f"the edge has the role {edge.role} and is sewn in seam {seam}; what the report says of a {edge.role} is measured along it",
                f"Leave the role out: the {edge.role} is the edge that stays free.",
            )  # fmt: skip


def _check_length(pattern: Pattern, seam: Seam, file: str | None) -> Iterator[Finding]:
    a, b = side_length(pattern, seam.a), side_length(pattern, seam.b)
    wanted = (1.0 + seam.ease) * b
    off = a - wanted
    allowed = max(_ABSOLUTE_MM, _RELATIVE * wanted)
    if abs(off) <= _NOTE_MM:
        return
    bad = abs(off) > allowed
    said = f"side a is {a:.1f} mm and side b {b:.1f} mm long; with the intended ease of {100 * seam.ease:g} % side a should be {wanted:.1f} mm"
    yield Finding(
        "error" if bad else "note", "seam-length", file, f"seams.{seam.name}",
        f"{said}, it is {abs(off):.1f} mm too {'long' if off > 0 else 'short'}" + (f" ({allowed:.1f} mm are allowed)" if bad else ""),
        f"Change the length of one side, or set ease: {a / b - 1.0:.4f} if it is meant so." if b > 0.0 else "Give both sides a length.",
    )  # fmt: skip


def _is_dart(pattern: Pattern, seam: Seam) -> bool:
    """Whether both sides are one panel's and run into one point of its outline: the legs of a dart that is drawn, and meant to be equal."""
    if seam.ease != 0.0 or len({use.panel for use in (*seam.a, *seam.b)}) > 1:
        return False
    edges = pattern.panels[seam.a[0].panel].edges
    (first_a, last_a), (first_b, last_b) = (
        (
            edges[side[0].edge].end if side[0].reverse else edges[side[0].edge].start,
            edges[side[-1].edge].start if side[-1].reverse else edges[side[-1].edge].end,
        )
        for side in (seam.a, seam.b)
    )
    return (first_a == first_b) != (last_a == last_b)


def _check_dart(pattern: Pattern, seam: Seam, file: str | None) -> Iterator[Finding]:
    a, b = side_length(pattern, seam.a), side_length(pattern, seam.b)
    if abs(a - b) > _DART_MM:
        bad = abs(a - b) > max(_ABSOLUTE_MM, _RELATIVE * b)
        yield Finding(
            "error" if bad else "warning", "dart-legs", file, f"seams.{seam.name}",
            f"the legs of the dart are {a:.1f} and {b:.1f} mm long; they differ by {abs(a - b):.1f} mm ({_DART_MM:g} mm are allowed)",
            "Move the apex square over the middle of the mouth, or true the mouth's ends: folded shut, the legs lie on each other.",
        )  # fmt: skip


def _check_notches(pattern: Pattern, seam: Seam, file: str | None) -> Iterator[Finding]:
    key = f"seams.{seam.name}"
    sides = (side_notches(pattern.panels, seam.a), side_notches(pattern.panels, seam.b))
    for side, notches in zip("ab", sides, strict=True):
        names = [name for name, _ in notches]
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield Finding(
                "error", "notch-twice", file, key, f"side {side} has {names.count(name)} notches called {name}",
                "Give them different names: the notches of a seam meet by name.",
            )  # fmt: skip
    places_a, places_b = dict(sides[0]), dict(sides[1])
    for side, only in (("a", places_a.keys() - places_b.keys()), ("b", places_b.keys() - places_a.keys())):
        for name in sorted(only):
            yield Finding(
                "note", "notch-alone", file, key, f"notch {name} stands on side {side} only",
                "Add a notch of this name to the other side where it shall meet, or leave it if it marks something else.",
            )  # fmt: skip
    shared = sorted(places_a.keys() & places_b.keys(), key=lambda name: places_a[name])
    if [*shared] != sorted(shared, key=lambda name: places_b[name]):
        yield Finding(
            "error", "notch-order", file, key, f"the notches {', '.join(shared)} (in order along side a) come in another order along side b",
            "Turn one side of the seam around, or swap the names.",
        )  # fmt: skip
        return
    whole_a, whole_b = side_length(pattern, seam.a), side_length(pattern, seam.b)
    for name in shared:
        ends = ((places_a[name], places_b[name], "start"), (whole_a - places_a[name], whole_b - places_b[name], "end"))
        # Where whole lengths differ (a finding of its own), a notch that is right from one end is right.
        a, b, end = min(ends, key=lambda place: abs(place[0] - (1.0 + seam.ease) * place[1]))
        wanted = (1.0 + seam.ease) * b
        if abs(a - wanted) > max(_ABSOLUTE_MM, _RELATIVE * wanted):
            yield Finding(
                "warning", "notch-mismatch", file, key,
                f"from the {end} to notch {name} side a is {a:.1f} mm and side b {b:.1f} mm long; with the intended ease a should be {wanted:.1f} mm "
                f"({max(_ABSOLUTE_MM, _RELATIVE * wanted):.1f} mm are allowed)",
                "Move the notch on one side, unless the ease is meant to be held here.",
            )  # fmt: skip
