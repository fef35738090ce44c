"""A fused interfacing against the mechanics of two layers, worked out here from the single sheets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from garmentcad.errors import FabricError
from garmentcad.fabric.fused import fused
from garmentcad.fabric.law_tension import solve_exponent
from garmentcad.fabric.material import material_row
from garmentcad.fabric.missing import complete
from garmentcad.fabric.sheet import KesSheet, sheet_from


def sheet(**values: Any) -> KesSheet:
    data = {"schema": 1, "name": "x", "source": "our laboratory", "W": 20.0, "T0": 0.5, "LT": 0.6, "EMT": 6.0, "G": 0.6, "B": 0.12, "2HB": 0.05, "MIU": 0.2}
    return complete(sheet_from({**data, **values})).sheet


FABRIC = sheet()
LIGHT = sheet(W=4.0, T0=0.2, LT=0.9, EMT={"warp": 3.0, "weft": 12.0}, G=1.1, B=0.02, **{"2HB": 0.02}, RT=80.0, MIU=0.3)


def force(one: KesSheet, way: str, strain: np.ndarray) -> np.ndarray:
    """gf/cm: the exponential through (0, 0) and (EMT, Fm) with the sheet's linearity, written out."""
    x = solve_exponent(one.number(f"LT.{way}"))
    return one.number("Fm") * np.expm1(x * strain / (one.number(f"EMT.{way}") / 100)) / np.expm1(x)


@pytest.mark.parametrize("way", ["warp", "weft"])
def test_tension_is_what_a_tester_prints_of_two_layers_side_by_side(way: str) -> None:
    made = fused(FABRIC, LIGHT)
    em = made.number(f"EMT.{way}") / 100
    strain = np.linspace(0.0, em, 20001)
    both = force(FABRIC, way, strain) + force(LIGHT, way, strain)
    assert both[-1] == pytest.approx(500.0, rel=1e-9)
    energy = np.trapezoid(both, strain)
    assert made.number(f"WT.{way}") == pytest.approx(energy, rel=1e-6)
    assert 2 * energy / (500.0 * em) == pytest.approx(made.number(f"LT.{way}"), rel=1e-6)
    given = sum(np.trapezoid(force(layer, way, strain), strain) * layer.number(f"RT.{way}") for layer in (FABRIC, LIGHT))
    assert made.number(f"RT.{way}") == pytest.approx(given / energy, rel=1e-6)  # each layer gives back its own share
    # one curve of the family stands for the sum of two: it has its ends and its energy
    assert np.abs(force(made, way, strain) - both).max() < 0.02 * 500.0


def test_a_layer_that_was_tested_to_less_is_pulled_to_the_larger_force() -> None:
    weak = sheet(W=4.0, T0=0.2, Fm=50.0, EMT=12.0)
    for made in (fused(FABRIC, weak), fused(weak, FABRIC)):
        assert made.number("Fm") == 500.0
        strain = np.array([made.number("EMT.warp") / 100])
        assert force(FABRIC, "warp", strain) + force(weak, "warp", strain) == pytest.approx(500.0, rel=1e-6)


def test_bonded_layers_of_one_kind_are_a_plate_of_twice_the_thickness() -> None:
    made = fused(FABRIC, FABRIC)
    for way in ("warp", "weft", "bias"):
        assert made.number(f"B.{way}") == pytest.approx(8.0 * FABRIC.number(f"B.{way}"))
        assert made.number(f"2HB.{way}") == pytest.approx(8.0 * FABRIC.number(f"2HB.{way}"))
    assert (made.number("W"), made.number("T0"), made.number("G.warp")) == pytest.approx((40.0, 1.0, 1.2))


def test_bending_about_the_neutral_axis() -> None:
    """Integral of E z^2 over both layers about the axis on which the membrane force of pure bending vanishes."""
    layers = [(0.0, 0.5, 12 * 0.12 / 0.5**3), (0.5, 0.7, 12 * 0.02 / 0.2**3)]  # from, to, modulus; gf.cm2/cm and mm throughout
    axis = sum(e * (b * b - a * a) / 2 for a, b, e in layers) / sum(e * (b - a) for a, b, e in layers)
    stiffness = sum(e * ((b - axis) ** 3 - (a - axis) ** 3) / 3 for a, b, e in layers)
    assert fused(FABRIC, LIGHT).number("B.warp") == pytest.approx(stiffness, rel=1e-12)


def test_factors_are_of_the_fabric_and_friction_too() -> None:
    made = fused(FABRIC, LIGHT, {"W": 2.0, "G": 3.0})
    assert made.number("W") == pytest.approx(44.0)
    assert made.number("G.weft") == pytest.approx(3 * 0.6 + 1.1)
    assert made.number("MIU.mean") == pytest.approx(0.2)
    assert made.name == "x + x"
    wide = sheet(shear_window_deg=[0.5, 5.0])
    assert fused(wide, LIGHT).shear_window_deg == wide.shear_window_deg != LIGHT.shear_window_deg == fused(LIGHT, wide).shear_window_deg
    row = material_row(FABRIC, {"W": 2.0, "G": 3.0}, LIGHT)
    assert row == material_row(made)
    assert row.areal_mass == pytest.approx(0.44)


def test_slopes_that_were_read_over_other_windows_add_up_as_laws() -> None:
    """The elastic part of a trellis of two is the sum of theirs, whatever window each sheet's G was read over."""
    apart = {"G": 1.0, "2HG": 2.0, "2HG5": 8.0, "shear_window_deg": [0.5, 8.0]}
    fabric, other = sheet(**{"2HG": 1.0, "2HG5": 2.0, "G": 0.5}), sheet(**apart, W=4.0, T0=0.2)
    elastic = material_row(fabric).shear + material_row(other).shear
    assert material_row(fused(fabric, other)).shear == pytest.approx(elastic, rel=1e-9)
    assert material_row(fused(other, fabric)).shear == pytest.approx(elastic, rel=1e-9)


def test_an_impossible_pair_names_the_value() -> None:
    with pytest.raises(FabricError, match="impossible") as caught:
        fused(FABRIC, LIGHT, {"W": 10.0})
    assert caught.value.key == "W"
