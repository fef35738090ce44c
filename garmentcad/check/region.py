"""Findings on regions without effect: they change nothing, or the lattice is too coarse for them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np
import shapely

from garmentcad.check.finding import Finding
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.materials import first_rows
from garmentcad.pattern.pattern import Pattern
from garmentcad.units import M_TO_MM


def check_regions(pattern: Pattern, cloth: Cloth, file: str | None) -> Iterator[Finding]:
    """Regions of the same cloth as the panel around them, and those whose cloth no element has, because none has its middle there; one for all mirror images
    of a region. cloth: laid out by `lay_out_sheets`, unsewn."""
    elements = (cloth.links, cloth.border, cloth.bends, cloth.spans)
    told: set[str] = set()
    used = set(np.concatenate([cloth.triangle_material, cloth.border.patch_material, *(kind.material for kind in elements)]).tolist())
    for name, row in first_rows(pattern).items():
        regions = enumerate(pattern.panels[name].regions, row + 1)
        for region, parts in groupby(regions, key=lambda part: part[1].name):  # a band that fell into pieces is one region
            rows, areas = zip(*((place, shapely.make_valid(shapely.Polygon(part.polygon_mm)).buffer(0.0)) for place, part in parts))
            part, key = pattern.panels[name].regions[rows[0] - row - 1], f"panels.{name}.regions.{region}"
            if part.key in told:
                continue
            plain = part.fabric is None and part.interfacing == pattern.panels[name].interfacing and all(factor == 1.0 for factor in part.factors.values())
            if plain and rows[0] == row + 1:  # a later one may take a part out of one before it
                told.add(part.key)
                yield Finding(
                    "warning", "region-without-effect", file, key, "it has the cloth of the panel: neither a factor, a fabric nor an interfacing of its own",
                    "Give it one, or leave the region out.",
                )  # fmt: skip
            elif used.isdisjoint(rows):
                told.add(part.key)
                width = max(2.0 * shapely.maximum_inscribed_circle(area, tolerance=0.1).length for area in areas)
                yield Finding(
                    "warning", "region-without-lattice", file, key,
                    f"no element of the lattice of {M_TO_MM * cloth.spacing:g} mm takes its cloth: the region is {width:.1f} mm wide where it is widest, "
                    "or later ones lie over all of it",
                    "Use a finer grid or make it wider, or put it after those that lie over it; as it is, it has no effect.",
                )  # fmt: skip
