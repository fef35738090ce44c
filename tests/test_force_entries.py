"""Each force is one compiled function of its arguments, positions and velocities; one specialisation serves cloths with and without its elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_cloth import deformed, materials, small_cloth

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import Cloth
from garmentcad.forces.bend import ForceBend, across_lines, write_bend
from garmentcad.forces.border import ForceBorder, write_border
from garmentcad.forces.hinge import ForceHinge, write_hinge
from garmentcad.forces.lattice import ForceLattice, write_lattice
from garmentcad.forces.span import ForceSpan, write_span

CLOTH = small_cloth()
MAKE = {
    write_lattice: lambda cloth: ForceLattice(cloth, materials(), damping_time=1e-5),
    write_border: lambda cloth: ForceBorder(cloth, materials(), 1e-5),
    write_bend: lambda cloth: ForceBend(cloth.bends, across_lines(cloth.bends), materials()),
    write_span: lambda cloth: ForceSpan(cloth, materials()),
    write_hinge: lambda cloth: ForceHinge(cloth, materials()),
}


def empty(cloth: Cloth) -> Cloth:
    """No elements and no lattice particles."""
    families = ("links", "cells", "border", "bends", "spans", "hinges")
    none = {name: type(getattr(cloth, name))(*(column[:0] for column in getattr(cloth, name))) for name in families}
    none["border"] = none["border"]._replace(patch_start=indices([0]))
    return replace(cloth, vertex_place=np.full_like(cloth.vertex_place, -1), **none)


@pytest.mark.parametrize("entry", MAKE)
def test_entry_writes_what_the_force_writes(entry) -> None:
    force = MAKE[entry](CLOTH)
    positions = deformed(CLOTH, "wavy")
    velocities = np.random.default_rng(0).normal(size=positions.shape)
    found, expected = np.zeros((2, len(force.corners), 3))
    force.write_forces(positions, velocities, expected)
    held = () if entry is write_span else (force.slack(),)
    entry(*force.arguments, *held, positions, velocities, found)
    assert expected.any()
    np.testing.assert_array_equal(found, expected)
    specialisations = len(entry.signatures)
    none = MAKE[entry](empty(CLOTH))
    out = np.zeros((len(none.corners), 3))
    none.write_forces(positions, velocities, out)
    assert not out.any()
    assert len(entry.signatures) == specialisations
