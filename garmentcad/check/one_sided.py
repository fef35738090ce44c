"""Seams that turn the cloth over: sewn so, its right side goes over into its wrong side somewhere.

Two panels that lie side by side, right side up, are sewn so that the seam runs along the outline of one and against that of the other. Where it runs along
both alike, one of them lies on its face, as a lining does. A garment may have both kinds, but no way from panel to panel and back may turn it over once: that
is a Moebius band. Where sides lie far apart as placed, as those of shoulder seams do, their distances do not tell a side that was sewn the wrong way round;
this does.
"""

from __future__ import annotations

from garmentcad.pattern.pattern import Pattern, Seam


def seams_turned_over(pattern: Pattern) -> list[str]:
    """Names of seams that run along both outlines alike although the other seams say that their panels lie the same way up, or the other way about."""
    over = {name: (name, False) for name in pattern.panels}  # to a panel that stands for all joined to it, and whether this one lies on its face beside it

    def place(panel: str) -> tuple[str, bool]:
        stands_for, turned = over[panel]
        if stands_for == panel:
            return panel, turned
        root, more = place(stands_for)
        over[panel] = (root, turned != more)
        return over[panel]

    found = []
    for seam in sorted((seam for seam in pattern.seams if seam.caught_in is None), key=alike):
        a, b = (place(side[0].panel) for side in (seam.a, seam.b))
        if a[0] != b[0]:
            over[a[0]] = (b[0], (a[1] != b[1]) != alike(seam))
        elif (a[1] != b[1]) != alike(seam):
            found.append(seam.name)
    return found


def alike(seam: Seam) -> bool:
    """Whether a seam runs along both outlines alike: of two panels that lie the same way up, both would lie on the same side of it."""
    return seam.a[0].reverse == seam.b[0].reverse
