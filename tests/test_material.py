"""Sheet to SI against numbers worked out by hand."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from garmentcad.errors import FabricError
from garmentcad.fabric.law_tension import loading
from garmentcad.fabric.material import MaterialRow, MaterialTable, material_row, material_table
from garmentcad.fabric.missing import complete
from garmentcad.fabric.quantity import KEYS
from garmentcad.fabric.sheet import KesSheet, sheet_from, sheet_sha256

DATA: dict[str, Any] = {
    "schema": 1,
    "name": "x",
    "source": "our laboratory",
    "W": 20.0,
    "T0": 0.6,
    "Fm": 500,
    "LT": {"warp": 1.0, "weft": 0.7},
    "EMT": {"warp": 5.0, "weft": 8.0},
    "G": {"warp": 0.6, "weft": 0.4},
    "2HG": {"warp": 0.8, "weft": 0.7},
    "2HG5": {"warp": 1.1, "weft": 0.94},
    "2HB": {"warp": 0.06, "weft": 0.05},
    "RT": {"warp": 60.0, "weft": 50.0},
    "B": {"warp": 0.12, "weft": 0.08, "bias": 0.1},
    "MIU": 0.2,
}


def completed(**changes: Any) -> KesSheet:
    return complete(sheet_from({**DATA, **changes})).sheet


def test_si_values_by_hand() -> None:
    row = material_row(completed())
    assert row.areal_mass == pytest.approx(0.2)
    assert row.tension_strain == pytest.approx((0.05, 0.08))
    assert row.tension_force == pytest.approx((490.3325, 490.3325))
    assert row.tension_exponent[0] == pytest.approx(0.0, abs=1e-9)
    assert row.tension_slope[0] == pytest.approx(490.3325 / 0.05)
    assert row.strain_limit[0] == pytest.approx(0.075)  # linear: 1.5 Fm at 1.5 em
    assert row.shear == pytest.approx(0.47 * 56.1879, rel=1e-5)  # 0.5 - (1.02 - 0.75)/9 gf/(cm.deg), 56.19 N/m per rad each
    assert row.shear_friction == pytest.approx((0.5 * 0.75 * 0.980665, 0.5 * 1.02 * 0.980665))
    assert row.shear_way == pytest.approx(row.shear_friction[0] / (10.0 * row.shear))
    assert row.tension_friction[0] == pytest.approx(0.2 / (1.0 - 2.0 * 0.28 / 3.0))  # LT 1: the turn over the last fifth lets 0.28/3 of 1/2 through
    assert row.bending_friction == pytest.approx((0.03 * 9.80665e-3, 0.025 * 9.80665e-3))
    assert row.twist_friction == 0.0
    assert row.bending == pytest.approx((0.12 * 9.80665e-5, 0.08 * 9.80665e-5))
    assert row.twist == pytest.approx(0.05 * 9.80665e-5)  # 0.1 - (0.12 + 0.08)/4
    assert row.thickness == pytest.approx(6e-4)
    assert (row.friction_body, row.friction_cloth) == pytest.approx((0.2, 0.26))


def test_weft_curve_carries_one_and_a_half_fm_at_its_limit() -> None:
    row = material_row(completed())
    arguments = (row.tension_strain[1], row.tension_force[1], row.tension_exponent[1], row.tension_slope[1])
    assert row.strain_limit[1] > row.tension_strain[1]
    assert loading(row.strain_limit[1], *arguments)[0] == pytest.approx(1.5 * 490.3325, rel=1e-12)
    assert 2 / arguments[2] - 2 / math.expm1(arguments[2]) == pytest.approx(0.7, rel=1e-12)


def test_off_axis_bending_of_the_table_is_the_bias_of_the_sheet() -> None:
    """Clamped wide specimen at 45 degrees: (Bw + Bf)/4 + D66 = B_bias."""
    row = material_row(completed())
    assert sum(row.bending) / 4 + row.twist == pytest.approx(0.1 * 9.80665e-5)
    assert material_row(completed(B={"warp": 0.12, "weft": 0.08, "bias": 0.04})).twist == 0.0


def test_factors_multiply() -> None:
    factors = {"B": 2, "B.warp": 1.5, "W": 3, "MIU": 0.5, "G.warp": 2.0, "EMT": 0.5, "2HG": 2.0, "2HG5": 2.0, "2HB": 3.0}
    row, plain = material_row(completed(), factors), material_row(completed())
    assert np.divide(row.bending, plain.bending) == pytest.approx((3.0, 2.0))
    assert row.areal_mass == pytest.approx(0.6)
    assert row.friction_cloth == pytest.approx(0.13)
    assert row.shear == pytest.approx((0.5 * (2 * 0.6 + 0.4) - 2 * 0.03) * 56.1879, rel=1e-5)
    assert np.divide(row.shear_friction, plain.shear_friction) == pytest.approx((2.0, 2.0))
    assert np.divide(row.bending_friction, plain.bending_friction) == pytest.approx((3.0, 3.0))
    assert row.tension_strain == pytest.approx((0.025, 0.04))
    assert row.twist == pytest.approx((0.2 - (0.36 + 0.16) / 4) * 9.80665e-5)


@pytest.mark.parametrize("factors", [{"B": 0}, {"B": -1.0}, {"B": float("nan")}, {"B": float("inf")}, {"B": True}, {"B": "2"}, {"Bee": 2.0}, {"B.up": 2.0}])
def test_factors_that_are_refused(factors: dict[str, Any]) -> None:
    with pytest.raises(FabricError):
        material_row(completed(), factors)


UNREAD = {key for key in KEYS if key.partition(".")[0] in ("WT", "Tm", "MIU", "MMD", "SMD", "LC", "WC", "RC") or key.endswith(".mean")} - {"MIU.mean"}


@pytest.mark.parametrize("key", [key for key in KEYS if key not in UNREAD])
def test_a_factor_on_what_the_laws_read_moves_something(key: str) -> None:
    """The sheet's bending and its hysteresis are such that those of the bias move the twist."""
    sheet = completed(B={"warp": 0.12, "weft": 0.08, "bias": 0.09}, **{"2HB": {"warp": 0.03, "weft": 0.03, "bias": 0.05}})
    assert material_row(sheet, {key: 1.1}) != material_row(sheet)


@pytest.mark.parametrize("key", sorted(UNREAD))
def test_a_factor_on_what_no_law_reads_is_refused(key: str) -> None:
    with pytest.raises(FabricError, match=rf"no law reads {re.escape(key)}; a factor may be on W, Fm, LT, EMT, RT, G"):
        material_row(completed(), {key: 1.1})


def test_more_resilience_than_all_is_refused() -> None:
    assert material_row(completed(), {"RT": 1.6}).tension_friction[0] == pytest.approx(0.02 / (1.0 - 2.0 * 0.28 / 3.0))
    with pytest.raises(FabricError, match="at most 100 %"):
        material_row(completed(), {"RT": 1.7})


def test_a_loop_that_widens_faster_than_it_rises_leaves_a_tenth_of_the_slope() -> None:
    assert material_row(completed(), {"2HG5": 9.0}).shear == pytest.approx(0.05 * 56.1879, rel=1e-5)


def test_a_sheet_with_gaps_is_refused() -> None:
    with pytest.raises(FabricError, match="complete the sheet first"):
        material_row(sheet_from(DATA | {"G": {"warp": 0.5}}))


def test_calibrated_law_stands_in_only_for_its_own_sheet() -> None:
    law = {"sheet_sha256": sheet_sha256(completed()), "values": {"G.warp": 0.7, "B.weft": 0.1}}
    row = material_row(completed(law=law), {"G": 2.0})
    assert row.shear == pytest.approx((2 * 0.55 - 0.03) * 56.1879, rel=1e-5)
    assert row.bending[1] == pytest.approx(0.1 * 9.80665e-5)
    assert material_row(completed(law=law, W=21.0)).bending == material_row(completed()).bending


def test_table_has_the_rows_in_order_as_arrays() -> None:
    rows = [material_row(completed()), material_row(completed(), {"W": 2.0})]
    table = material_table(rows)
    assert MaterialRow._fields == MaterialTable._fields
    for name, column in table._asdict().items():
        assert column.dtype == np.float64
        assert column.flags.c_contiguous
        assert column.shape == ((2, 2) if isinstance(getattr(rows[0], name), tuple) else (2,))
        assert column[1] == pytest.approx(np.asarray(getattr(rows[1], name)))
    assert table.areal_mass.tolist() == pytest.approx([0.2, 0.4])
    with pytest.raises(FabricError, match="at least one row"):
        material_table([])


@pytest.mark.parametrize(("window", "rising"), [([0.5, 5.0], 1.0), ([0.5, 6.5], 0.75), ([5.0, 8.0], 0.0), ([0.5, 1.0], 1.0)])
def test_the_slope_holds_as_much_of_friction_as_its_window(window: list[float], rising: float) -> None:
    """H rises from 0.5 to 5 degrees by (1.02 - 0.75)/2 gf/cm."""
    assert material_row(completed(shear_window_deg=window)).shear == pytest.approx((0.5 - rising * 0.03) * 56.1879, rel=1e-5)
