"""The curves that a sheet stands for, without any lattice: what a passport draws the records over. PHYSICS 1, in the testers' units."""

from __future__ import annotations

import math

import numpy as np

from garmentcad.fabric.law_shear import elastic_slope
from garmentcad.fabric.law_tension import solve_exponent
from garmentcad.fabric.sheet import KesSheet
from garmentcad.rigs.kes import KesTester
from garmentcad.rigs.loop import Branch

_POINTS = 101


def sheet_curves(sheet: KesSheet, tester: KesTester, largest: float) -> tuple[Branch, ...]:
    """Ways out and back of a completed sheet up to the deformation `largest`, friction fully drawn on each."""
    if tester.kind == "tension":
        emt, force = sheet.number(f"EMT.{tester.way}"), sheet.number("Fm")
        exponent = solve_exponent(sheet.number(f"LT.{tester.way}"))
        strain = np.linspace(0.0, emt, _POINTS)
        loading = force * (strain / emt if abs(exponent) < 1e-6 else np.expm1(exponent * strain / emt) / math.expm1(exponent))
        return Branch(strain, loading), Branch(strain, 0.01 * sheet.number(f"RT.{tester.way}") * loading)
    across = np.linspace(-largest, largest, 2 * _POINTS)
    if tester.kind == "shear":
        narrow, wide = sheet.number(f"2HG.{tester.way}"), sheet.number(f"2HG5.{tester.way}")
        half = 0.5 * np.interp(np.abs(across), [0.5, 5.0], [narrow, wide])
        elastic = elastic_slope(sheet.number(f"G.{tester.way}"), narrow, wide, sheet.shear_window_deg) * across
    else:
        half = np.full_like(across, 0.0 if tester.way == "bias" else 0.5 * sheet.number(f"2HB.{tester.way}"))  # the bias is tested without friction
        elastic = sheet.number(f"B.{tester.way}") * across
    return Branch(across, elastic + half), Branch(across, elastic - half)
