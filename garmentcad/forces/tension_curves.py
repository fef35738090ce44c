"""The tensile curves of a material table as rows for kernels: row 2 m is the warp of material m, row 2 m + 1 its weft."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, kernel
from garmentcad.fabric.law_tension import tension, tension_energy
from garmentcad.fabric.material import MaterialTable


class TensionCurves(NamedTuple):
    """Arguments of `law_tension.tension`, one row per material and direction, (2M,) each."""

    em: np.ndarray
    fm: np.ndarray  # N/m
    exponent: np.ndarray
    slope: np.ndarray  # N/m


def tension_curves(materials: MaterialTable) -> TensionCurves:
    columns = (materials.tension_strain, materials.tension_force, materials.tension_exponent, materials.tension_slope)
    return TensionCurves(*(np.array(column, dtype=np.float64).ravel() for column in columns))


@kernel
def evaluate_tension(curves, rows, strain, energy, force, tangent):  # type: ignore[no-untyped-def]
    for i in range(len(rows)):
        r = rows[i]
        energy[i] = tension_energy(strain[i], curves.em[r], curves.fm[r], curves.exponent[r], curves.slope[r])
        force[i], tangent[i] = tension(strain[i], curves.em[r], curves.fm[r], curves.exponent[r], curves.slope[r])


def tension_at(curves: TensionCurves, rows: np.ndarray, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy per area [J/m2], force per width [N/m] and tangent [N/m] of each strain (N,) on the curve of its row (N,)."""
    energy, force, tangent = (np.empty(len(rows)) for _ in range(3))
    evaluate_tension(curves, rows, floats(strain), energy, force, tangent)
    return energy, force, tangent
