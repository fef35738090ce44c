"""The tensile curves of a material table as rows for kernels: row 2 m is the warp of material m, row 2 m + 1 its weft."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, floats, kernel
from garmentcad.fabric.law_tension import WAY, loading, tension_energy
from garmentcad.fabric.material import MaterialTable


class TensionCurves(NamedTuple):
    """Arguments of `law_tension.tension`, one row per material and direction, (2M,) each."""

    friction: np.ndarray  # c
    em: np.ndarray
    fm: np.ndarray  # N/m
    exponent: np.ndarray
    slope: np.ndarray  # N/m


def tension_curves(materials: MaterialTable) -> TensionCurves:
    names = ("tension_friction", "tension_strain", "tension_force", "tension_exponent", "tension_slope")
    return TensionCurves(*(np.array(getattr(materials, name), dtype=np.float64).ravel() for name in names))


@entry
@kernel
def evaluate_loading(curves, rows, strain, force, tangent):  # type: ignore[no-untyped-def]
    for i in range(len(rows)):
        r = rows[i]
        force[i], tangent[i] = loading(strain[i], curves.em[r], curves.fm[r], curves.exponent[r], curves.slope[r])


@entry
@kernel
def evaluate_energy(curves, rows, strain, sliders, energy):  # type: ignore[no-untyped-def]
    for i in range(len(rows)):
        r = rows[i]
        energy[i] = tension_energy(strain[i], sliders[i], curves.friction[r], curves.em[r], curves.fm[r], curves.exponent[r], curves.slope[r])


def largest_tension_at(curves: TensionCurves, rows: np.ndarray, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest force per width [N/m] and largest tangent [N/m] that each strain (N,) can have on the curve of its row (N,), whatever its slider."""
    force, tangent = np.empty(len(rows)), np.empty(len(rows))
    evaluate_loading(curves, rows, floats(strain), force, tangent)
    stick = curves.friction[rows] / (WAY * curves.em[rows]) * np.maximum(force, 0.0)
    return force, tangent + stick


def tension_energy_at(curves: TensionCurves, rows: np.ndarray, strain: np.ndarray, sliders: np.ndarray) -> np.ndarray:
    """Stored energy per area [J/m2] of each strain (N,) with its slider (N,) on the curve of its row (N,)."""
    energy = np.empty(len(rows))
    evaluate_energy(curves, rows, floats(strain), floats(sliders), energy)
    return energy
