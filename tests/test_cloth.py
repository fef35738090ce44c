"""The contract of Cloth: arrays are read-only and typed as kernels read them; vertices and particles agree before welding."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import materials

from garmentcad.cloth.lattice import rectangle_cloth

CLOTH = rectangle_cloth(150, 50, 10, 30.0, materials(0.12))
ARRAYS = {
    **{
        name: getattr(CLOTH, name)
        for name in ("vertex_uv_mm", "vertex_panel", "vertex_particle", "vertex_on_contour", "masses", "triangles", "triangle_material", "stitches")
    },
    **{f"{family}.{name}": array for family in ("links", "cells", "border", "bends", "hinges") for name, array in getattr(CLOTH, family)._asdict().items()},
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_are_what_kernels_read(name: str) -> None:
    array = ARRAYS[name]
    assert array.dtype in (np.float64, np.int32, np.bool_)
    assert array.flags.c_contiguous
    assert not array.flags.writeable
    if array.dtype == np.float64:
        assert np.isfinite(array).all()


def test_vertices_and_particles_are_one_before_welding() -> None:
    assert CLOTH.particle_count == len(CLOTH.vertex_uv_mm) == len(CLOTH.masses)
    assert np.array_equal(CLOTH.particle_triangles, CLOTH.triangles)
    assert CLOTH.spacing == pytest.approx(0.01)
