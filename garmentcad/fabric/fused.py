"""A fused interfacing: the sheet of a fabric with an interfacing bonded to it, from both sheets. All of it is an estimate; a measured fused sheet is better.

    W, T0, 2HG, 2HG5: sums            tension: F(e) = F_f(e) + F_i(e), both at the same strain; G: G_f + G_i, over the window of the fabric
    B = B_f + B_i + E_f E_i/(E_f + E_i) d^2,   E = 12 B/T0^2 of each layer,   d = (T0_f + T0_i)/2
    2HB = (2HB_f + 2HB_i) B/(B_f + B_i)

The last term of B is what a bonded pair has beyond one that slips: two equal layers give 8 B, a plate of twice the thickness, and 2 B where they slip. It is
the laminate of Kim, Inui and Takatera (Textile Research Journal 82, 2012, 385), who found that the modulus in bending has to be taken from bending tests,
because tensile moduli are far too large; here both moduli of a layer are the one that its own B and T0 give. G of the sum is a lower bound: the adhesive
also locks crossings of the yarns (Kim and Takatera, Textile Research Journal 86, 2016, 480: in proportion to its mass). Friction stays that of the fabric.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from scipy.integrate import quad
from scipy.optimize import brentq

from garmentcad.fabric.law_shear import slope_over
from garmentcad.fabric.law_tension import initial_slope, loading, solve_exponent
from garmentcad.fabric.law_values import law_numbers
from garmentcad.fabric.sheet import KesSheet, KesValue

_SUM = "sum of fabric and interfacing"
_PARALLEL = "fabric and interfacing side by side at one strain"
_LAMINATE = "laminate of fabric and interfacing, moduli 12 B/T0^2"


class _Curve(NamedTuple):
    """Arguments of `law_tension.loading` after the strain, Fm in the tester's unit."""

    em: float
    fm: float
    exponent: float
    slope: float


def fused(fabric: KesSheet, interfacing: KesSheet, factors: Mapping[str, float] | None = None) -> KesSheet:
    """Sheet of `fabric` with `interfacing` fused to it, warp along warp; both completed. factors: of the fabric, before (`law_numbers`).

    FabricError where a value of the pair is impossible.
    """
    f, i = law_numbers(fabric, factors), law_numbers(interfacing)
    for way in ("warp", "weft"):
        slope, narrow, wide = (i[f"{name}.{way}"] for name in ("G", "2HG", "2HG5"))
        i[f"G.{way}"] = slope_over(fabric.shear_window_deg, slope, narrow, wide, interfacing.shear_window_deg)
    found: dict[str, KesValue] = {}

    def put(key: str, number: float, rule: str) -> None:
        found[key] = KesValue(value=number, estimate=rule)

    for key in ("W", "T0", *(f"{name}.{way}" for name in ("G", "2HG", "2HG5") for way in ("warp", "weft"))):
        put(key, f[key] + i[key], _SUM)
    fm = max(f["Fm"], i["Fm"])
    put("Fm", fm, "the larger one")
    for way in ("warp", "weft"):
        curves = [_curve(numbers, way) for numbers in (f, i)]
        em = float(brentq(lambda e: sum(loading(e, *curve)[0] for curve in curves) - fm, 0.0, max(curve.em for curve in curves), xtol=1e-12))  # noqa: B023
        energies = [quad(lambda e, one=curve: loading(e, *one)[0], 0.0, em, points=[min(curve.em, em)])[0] for curve in curves]
        put(f"EMT.{way}", 100.0 * em, _PARALLEL)
        put(f"WT.{way}", sum(energies), _PARALLEL)
        put(f"LT.{way}", 2.0 * sum(energies) / (fm * em), _PARALLEL)
        put(f"RT.{way}", sum(energy * numbers[f"RT.{way}"] for energy, numbers in zip(energies, (f, i))) / sum(energies), _PARALLEL)
    for way in ("warp", "weft", "bias"):
        slipping = f[f"B.{way}"] + i[f"B.{way}"]
        moduli = [12.0 * numbers[f"B.{way}"] / numbers["T0"] ** 2 for numbers in (f, i)]
        bonded = slipping + moduli[0] * moduli[1] / (moduli[0] + moduli[1]) * (0.5 * (f["T0"] + i["T0"])) ** 2
        put(f"B.{way}", bonded, _LAMINATE)
        put(f"2HB.{way}", (f[f"2HB.{way}"] + i[f"2HB.{way}"]) * bonded / slipping, "sum, in the ratio of B to the sum of B")
    put("MIU.mean", f["MIU.mean"], "of the fabric")
    bare = KesSheet(schema=1, name=f"{fabric.name} + {interfacing.name}"[:80], fibre=fabric.fibre, shear_window_deg=fabric.shear_window_deg)
    return bare.with_values(found)


def _curve(numbers: dict[str, float], way: str) -> _Curve:
    em, fm, exponent = numbers[f"EMT.{way}"] / 100.0, numbers["Fm"], solve_exponent(numbers[f"LT.{way}"])
    return _Curve(em, fm, exponent, float(initial_slope(em, fm, exponent)))
