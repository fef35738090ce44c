"""Labels as laboratories print them."""

from __future__ import annotations

import pytest

from garmentcad.fabric.quantity import QUANTITIES
from garmentcad.io.kes_header import FIT_QUANTITIES, Label, read_label

UNDERSTOOD = {
    "B warp (gf.cm2/cm)": ("B.warp", 1.0),
    "2HB-weft [gf·cm/cm]": ("2HB.weft", 1.0),
    "G_gf_cm_deg_mean": ("G.mean", 1.0),
    "G (gf/cm·degree) Warp": ("G.warp", 1.0),
    "2HG5_gf_cm_mean": ("2HG5.mean", 1.0),
    "2HG (5°)": ("2HG5.mean", 1.0),
    "2HG 0.5° weft gf/cm": ("2HG.weft", 1.0),
    "2HG1": ("2HG.warp", 1.0),
    "2hg52": ("2HG5.weft", 1.0),
    "B2": ("B.weft", 1.0),
    "EMT-1 %": ("EMT.warp", 1.0),
    "RT [%] filling": ("RT.weft", 1.0),
    "Weft WT (gf·cm/cm²)": ("WT.weft", 1.0),
    "weight_g_m2": ("W", 0.1),
    "Weight (g/m²)": ("W", 0.1),
    "Mass per unit area, mg/cm^2": ("W", 1.0),
    "thickness_mm": ("T0", 1.0),
    "Bending rigidity B, weft": ("B.weft", 1.0),
    "B_bias_gfcm2_cm": ("B.bias", 1.0),
    "B µN·m mean": ("B.mean", 1 / 98.0665),
    "Fm N/m": ("Fm", 1 / 0.980665),
    "G N/m": ("G.mean", 1 / 56.187965),
    "G [N/(m·rad)] warp": ("G.warp", 1 / 56.187965),
    "G N/m/deg": ("G.mean", 1 / 0.980665),
    "B [mN·m] warp": ("B.warp", 1000 / 98.0665),
    "2HB weft (mN)": ("2HB.weft", 1 / 9.80665),
    "2HB N": ("2HB.mean", 1000 / 9.80665),
    "MMD": ("MMD.mean", 1.0),
    "SMD_um": ("SMD.mean", 1.0),
    "LT": ("LT.mean", 1.0),
    "Areal density, gsm": ("W", 0.1),
    "T0 [cm]": ("T0", 10.0),
    "Thickness Tm, mm": ("Tm", 1.0),
    "SMD warp (micron)": ("SMD.warp", 1.0),
    "Geometrical roughness weft": ("SMD.weft", 1.0),
    "Tensile linearity warp": ("LT.warp", 1.0),
    "Tensile energy (J/m²) warp": ("WT.warp", 1 / 0.980665),
    "Tensile resilience weft, percent": ("RT.weft", 1.0),
    "Tensile strain avg": ("EMT.mean", 1.0),
    "Extensibility pct 2": ("EMT.weft", 1.0),
    "Shear rigidity warp": ("G.warp", 1.0),
    "Shear stiffness average (gf/cm.deg)": ("G.mean", 1.0),
    "2HG 5 warp": ("2HG5.warp", 1.0),
    "2HG 0.5 weft": ("2HG.weft", 1.0),
    "Bending stiffness bias": ("B.bias", 1.0),
    "Friction coefficient warp": ("MIU.warp", 1.0),
    "Coefficient of friction": ("MIU.mean", 1.0),
}
OF_FAST = {
    "Bending length weft (cm)": ("C.weft", 10.0),
    "E5 %": ("E5.mean", 1.0),
    "C1 mm": ("C.warp", 1.0),
    "Bias extension, %": ("EB5", 1.0),
    "Cantilever length warp": ("overhang.warp", 1.0),
    "Overhang length 2": ("overhang.weft", 1.0),
    "2HB/B [1/cm]": ("2HB/B", 1.0),
    "2HB / B (1/m)": ("2HB/B", 0.01),
}


@pytest.mark.parametrize("text", list(UNDERSTOOD))
def test_understood(text: str) -> None:
    key, factor = UNDERSTOOD[text]
    assert read_label(text) == Label(key, pytest.approx(factor, rel=1e-7))


@pytest.mark.parametrize("text", list(OF_FAST))
def test_labels_of_fast_are_understood_among_its_quantities_only(text: str) -> None:
    key, factor = OF_FAST[text]
    assert read_label(text, FIT_QUANTITIES) == Label(key, pytest.approx(factor, rel=1e-7))
    assert read_label(text) is None


@pytest.mark.parametrize(
    "text", ["B sd", "DC_pct", "B [lbf in]", "T0 um", "EMT bias", "W warp", "G window", "Mean", "", "notes", "B warp weft", "LT %", "weight loss %", "2HG 8"]
)
def test_not_understood(text: str) -> None:
    assert read_label(text) is None


def test_every_name_of_the_sheet_with_its_own_unit() -> None:
    for quantity in QUANTITIES.values():
        for way in quantity.directions or ("",):
            label = read_label(f"{quantity.name} {way} ({quantity.unit})")
            assert label == Label(f"{quantity.name}.{way}" if way else quantity.name, 1.0)
