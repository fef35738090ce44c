"""Material tables by hand, without internal friction: closed forms know none."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats
from garmentcad.fabric.material import MaterialTable

FRICTIONS = {"tension_friction": 2, "shear_friction": 2, "shear_way": 1, "bending_friction": 2, "twist_friction": 1}


def elastic(areal_mass: np.ndarray, **columns: np.ndarray) -> MaterialTable:
    """The columns given, friction 0."""
    rows = len(areal_mass)
    none = {name: np.zeros((rows, width) if width > 1 else rows) for name, width in FRICTIONS.items()}
    return MaterialTable(areal_mass=floats(areal_mass), **none, **{name: floats(column) for name, column in columns.items()})


def linear(areal_mass: float, stiffness: float, limit: float, shear: float, thickness: float, friction: float, bending: float = 1e-5) -> MaterialTable:
    """One row, tension linear and alike in warp and weft [N/m]; limit: the strain limit."""
    both, one = floats([[1.0, 1.0]]), floats([1.0])
    return elastic(
        areal_mass * one, tension_strain=0.2 * both, tension_force=0.2 * stiffness * both, tension_exponent=0.0 * both, tension_slope=stiffness * both,
        strain_limit=limit * both, shear=shear * one, bending=bending * both, twist=0.5 * bending * one, thickness=thickness * one,
        friction_body=friction * one, friction_cloth=friction * one,
    )  # fmt: skip
