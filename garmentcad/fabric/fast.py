"""FAST readings and cantilever lengths to KES values, with the bounds that the readings leave.

    extensions E5, E20, E100 [%] at 5, 20, 100 gf/cm    points on F = Fm (exp(x e/em) - 1)/(exp(x) - 1), Fm = 100 gf/cm -> EMT, LT
    bias extension EB5 [%] at 5 gf/cm                   G = F/(4 e) = 122.6/EB5 N/m (stiff yarns: the off-axis modulus at 45 degrees is 4G)
    bending length C [mm], overhang [mm] at 41.5 deg    B = W g (L/2.0004)^3, L = 2 C: the exact elastica (`cantilever`); with 2HB, that of a
                                                        strip whose friction keeps a part of what it was bent at the edge
    2HB/B [1/cm] of such cloth, believed                with a length: B and 2HB that have it together

Fm stays at 100 gf/cm, the largest load of FAST-3: the sheet says so, and nothing is extrapolated to the 500 gf/cm of the KES tester.
What these tests cannot tell, because none of them unloads: RT, 2HG, 2HG5, 2HB. Where neither 2HB nor 2HB/B is given, the friction in a length stays in B, as in
that of a FAST report: for H c/B of 0.1, 0.3 and 0.5, H = 2HB/2, B is 7 % too low, 11 and 33 % too high. Its bounds then reach to the B that has the length
together with the 2HB that fills the gap. Sources: De Boos and Tester 1994, SiroFAST (the tests and G); readings are to 0.1 %, 0.5 mm.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from garmentcad.errors import FabricError
from garmentcad.fabric.cantilever import bending_from_overhang
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.fitted import FittedValue
from garmentcad.fabric.law_tension import linearity, solve_exponent, strain_at_force
from garmentcad.fabric.missing import USUAL_2HB
from garmentcad.fabric.quantity import BENDING_WAYS, WAYS, Quantity, quantity_of
from garmentcad.units import GF_CM2_CM_TO_N_M, GF_CM_CM_TO_N, GF_CM_DEG_TO_N_M_RAD, GF_CM_TO_N_M, GRAVITY_M_S2, MG_CM2_TO_KG_M2, MM_TO_M

RATIO = "2HB/B"

FAST_QUANTITIES: dict[str, Quantity] = {
    q.name: q
    for q in (
        Quantity("E5", "%", "extension at 5 gf/cm", (0.0, 50.0), (0.0, 5.0), WAYS),
        Quantity("E20", "%", "extension at 20 gf/cm", (0.0, 80.0), (0.1, 10.0), WAYS),
        Quantity("E100", "%", "extension at 100 gf/cm", (0.2, 150.0), (0.5, 20.0), WAYS),
        Quantity("EB5", "%", "bias extension at 5 gf/cm", (0.2, 80.0), (1.0, 15.0)),
        Quantity("C", "mm", "bending length, half the overhang at 41.5 degrees", (3.0, 100.0), (8.0, 40.0), BENDING_WAYS),
        Quantity("overhang", "mm", "overhang at 41.5 degrees", (6.0, 200.0), (16.0, 80.0), BENDING_WAYS),
        Quantity(RATIO, "1/cm", "bending hysteresis over bending stiffness", (0.0, 5.0), (0.2, 2.0)),
    )
}

LOADS_GF_CM = {"E5": 5.0, "E20": 20.0, "E100": 100.0}
FORCE_GF_CM = 100.0  # Fm of a sheet from FAST
EXTENSION_READING = 0.05  # +- %
MOST_MISSED = 4.0  # readings within which a curve is one of such cloth
AT_END = 1e-3  # of LT: nearer to what a sheet may have it was stopped there
LENGTH_READING = 0.5  # +- mm of the overhang
WEIGHT_READING = 0.01  # +- share of W


class _Curve(NamedTuple):
    em: float
    exponent: float
    miss: float  # largest distance to a reading, %


def fit_fast(values: Mapping[str, float]) -> list[FittedValue]:
    """KES values from FAST readings by key (`E5.warp`, `EB5`, `C.weft`) and W [mg/cm2]; keys of the sheet itself are left alone.

    FabricError for readings that no cloth can have, and for a length without W.
    """
    for key, number in values.items():
        quantity = FAST_QUANTITIES.get(key.partition(".")[0])
        if quantity and not quantity.possible[0] <= number <= quantity.possible[1]:
            low, high = quantity.possible
            raise FabricError(f"{number:g} {quantity.unit} is impossible for {quantity.meaning}; {low:g} to {high:g} is allowed", key=key)
    fitted = []
    for way in WAYS:
        fitted += _tension(_extensions(values, way), way)
    if fitted:
        of = tuple(key for key in values if key.partition(".")[0] in LOADS_GF_CM)
        fitted.append(FittedValue("Fm", FORCE_GF_CM, FORCE_GF_CM, FORCE_GF_CM, "the largest load of FAST-3", of))
    if "EB5" in values:
        fitted.append(_shear(values["EB5"], values))
    for way in BENDING_WAYS:
        lengths = {name: values[f"{name}.{way}"] * factor for name, factor in (("C", 2.0), ("overhang", 1.0)) if f"{name}.{way}" in values}
        if len(lengths) == 2:
            raise FabricError("both a bending length and an overhang are given; one of them is allowed", key=f"C.{way}")
        for name, overhang in lengths.items():
            fitted += _bending(name, overhang, way, values)
    if RATIO in values and not any(RATIO in value.of for value in fitted):
        raise FabricError("it needs a length of a cantilever in a direction of which no 2HB is given; there is none, leave it out", key=RATIO)
    return fitted


def doubtful(values: Mapping[str, float]) -> list[Finding]:
    """Findings on extensions of which `fit_fast` makes a curve that they do not lie on, or one at the end of what a sheet may have; and
    on lengths whose friction stays in B."""
    found = []
    for name, way in itertools.product(("C", "overhang"), BENDING_WAYS):
        if f"{name}.{way}" in values and RATIO not in values and not _hysteresis(way, values)[1]:
            why = f"friction is in it, and the 2HB that stands in by a rule makes the cloth stiffer once more than {name} says"
            found.append(Finding("warning", f"B.{way}", f"{why}; give 2HB, or {RATIO} (cottons about 1 /cm, wool and polyester 0.4), and it is taken out"))
    for way in WAYS:
        readings = _extensions(values, way)
        if len(readings) < 2:
            continue
        curve = _fit_curve([LOADS_GF_CM[name] for name in readings], list(readings.values()))
        came = ", ".join(f"{name} {value:g} %" for name, value in readings.items())
        if curve.miss > MOST_MISSED * EXTENSION_READING:
            why = f"no curve of a tensile tester goes through {came}: it misses one by {curve.miss:.2f} %, where readings are good to {EXTENSION_READING:g} %"
            found.append(Finding("warning", f"EMT.{way}", why))
        linear = linearity(curve.exponent)
        if any(abs(linear - end) < AT_END for end in quantity_of("LT").possible):
            found.append(Finding("warning", f"LT.{way}", f"{came} ask for an LT beyond {linear:.2f}, the last that a sheet may have; it is no measurement"))
    return found


def _extensions(values: Mapping[str, float], way: str) -> dict[str, float]:
    """The extensions [%] of a direction by name (`E5`)."""
    return {name: values[f"{name}.{way}"] for name in LOADS_GF_CM if f"{name}.{way}" in values}


def _tension(readings: dict[str, float], way: str) -> list[FittedValue]:
    """EMT and LT from the extensions of one direction; LT needs two of them at least."""
    if not readings:
        return []
    if "E100" not in readings:
        raise FabricError("E100 is missing; the other extensions need it, it is the end of the curve", key=f"E100.{way}")
    strains = list(readings.values())
    if strains != sorted(strains):
        raise FabricError(f"{', '.join(f'{name} = {value:g} %' for name, value in readings.items())}: a larger load cannot stretch less", key=f"E100.{way}")
    forces = [LOADS_GF_CM[name] for name in readings]
    of = tuple(f"{name}.{way}" for name in readings)
    if len(readings) == 1:
        end = strains[0]
        return [FittedValue(f"EMT.{way}", end, end - EXTENSION_READING, end + EXTENSION_READING, "E100 as read", of)]
    best = _fit_curve(forces, strains)
    spread = max(EXTENSION_READING, best.miss)
    corners = [_fit_curve(forces, [e + s * spread for e, s in zip(strains, signs)]) for signs in itertools.product((-1.0, 1.0), repeat=len(strains))]
    how = f"exponential law through {', '.join(readings)}, off by {best.miss:.2f} % at most; readings +-{spread:.2f} %"
    ends = [curve.em for curve in (best, *corners)]
    shapes = [linearity(curve.exponent) for curve in (best, *corners)]
    return [FittedValue(f"EMT.{way}", best.em, min(ends), max(ends), how, of), FittedValue(f"LT.{way}", shapes[0], min(shapes), max(shapes), how, of)]


def _fit_curve(forces: list[float], strains: list[float]) -> _Curve:
    """Bounded least squares of em [%] and the exponent; the exponents are those of the linearities that a sheet may have."""
    lowest, highest = quantity_of("LT").possible
    bounds = (solve_exponent(highest), solve_exponent(lowest))

    def misses(p: np.ndarray) -> np.ndarray:
        return np.array([strain_at_force(force, p[0], FORCE_GF_CM, p[1]) - strain for force, strain in zip(forces, strains)])

    shortest, longest = quantity_of("EMT").possible
    end = min(max(strains[-1], shortest), longest)
    ends = max(0.5 * end, shortest), min(2.0 * end, longest)
    found = least_squares(misses, (end, 2.0), bounds=((ends[0], bounds[0]), (ends[1], bounds[1])), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return _Curve(float(found.x[0]), float(found.x[1]), float(np.abs(found.fun).max()))


def _shear(bias: float, values: Mapping[str, float]) -> FittedValue:
    """G from the bias extension. Yarns that stretch take a part of it, 1/E45 = (1/G + 1/E1 + 1/E2)/4, which sets the upper bound where E5 is known."""
    force = LOADS_GF_CM["E5"] * GF_CM_TO_N_M
    yarns = [next((key for key in (f"E5.{way}", "E5.mean") if key in values), None) for way in ("warp", "weft")]
    of = [yarn for yarn in yarns if yarn is not None]
    known = [values[yarn] + EXTENSION_READING for yarn in of]
    rest = 4.0 * (bias - EXTENSION_READING) - sum(known)
    if rest <= 0.5 * bias:
        raise FabricError(f"{bias:g} % is no more than its yarns give (E5 {', '.join(f'{values[yarn]:g}' for yarn in of)} %)", key="EB5")

    def stiffness(stretch_percent: float) -> float:
        return force / (stretch_percent / 100.0) / GF_CM_DEG_TO_N_M_RAD

    how = "122.6/EB5 N/m, reading +-0.05 %" + ("; the upper bound lets the yarns take their E5" if known else "; yarns taken as stiff")
    return FittedValue("G.mean", stiffness(4.0 * bias), stiffness(4.0 * (bias + EXTENSION_READING)), stiffness(rest), how, ("EB5", *dict.fromkeys(of)))


def _bending(name: str, overhang_mm: float, way: str, values: Mapping[str, float]) -> list[FittedValue]:
    """B from the overhang at 41.5 degrees, and 2HB where its ratio to B is given. name: of the length that was read."""
    if "W" not in values:
        raise FabricError("W is missing; a length of a cantilever gives B only with the mass per area", key="W")
    weight = values["W"] * MG_CM2_TO_KG_M2 * GRAVITY_M_S2
    hysteresis, hysteresis_of = _hysteresis(way, values)
    holds = 0.5 * hysteresis * GF_CM_CM_TO_N

    def stiffness(length_mm: float, share: float, ratio: float) -> float:
        try:
            return bending_from_overhang(length_mm * MM_TO_M, share * weight, holds, 0.5 * ratio * GF_CM_CM_TO_N / GF_CM2_CM_TO_N_M) / GF_CM2_CM_TO_N_M
        except ValueError:
            came = f"2HB = {hysteresis:g} gf.cm/cm alone bears a strip of {values['W']:g} mg/cm2 at an overhang of {overhang_mm:g} mm"
            raise FabricError(f"{came}, so that it says nothing of B; correct either", key=f"{name}.{way}") from None

    def of_ratio(ratio: float) -> tuple[float, float, float]:
        low, high = (stiffness(overhang_mm + s * LENGTH_READING, 1.0 + s * WEIGHT_READING, ratio) for s in (-1.0, 1.0))
        return stiffness(overhang_mm, 1.0, ratio), low, high

    given = not hysteresis_of and RATIO in values
    best, *bounds = of_ratio(values[RATIO] if given else 0.0)
    if given:
        friction = f"2HB = {values[RATIO]:g} /cm x B taken out"
    elif hysteresis_of:
        friction = f"2HB = {hysteresis:.4g} gf.cm/cm taken out"
    else:
        usual, *usual_bounds = of_ratio(USUAL_2HB)
        friction, bounds = f"friction not taken out, 2HB is not given; with the usual {USUAL_2HB:g} /cm x B it is {usual:.4g}", [*bounds, *usual_bounds]
    how = f"exact elastica, overhang {overhang_mm:g} mm at 41.5 degrees, {friction}; readings +-0.5 mm, W +-1 %"
    of = (f"{name}.{way}", "W", *hysteresis_of)
    found = [FittedValue(f"B.{way}", best, min(bounds), max(bounds), how, (*of, RATIO) if given else of)]
    if given:
        ratio, how = values[RATIO], f"{values[RATIO]:g} /cm x B, as it was given"
        found.append(FittedValue(f"2HB.{way}", ratio * best, ratio * min(bounds), ratio * max(bounds), how, (*of, RATIO), estimate=True))
    return found


def _hysteresis(way: str, values: Mapping[str, float]) -> tuple[float, tuple[str, ...]]:
    """2HB [gf.cm/cm] of a direction and the keys that gave it; 0 and none where nothing does. Of the bias as the rules for gaps have it."""
    choices = [(f"2HB.{way}",), ("2HB.warp", "2HB.weft") if way == "bias" else (), ("2HB.mean",)]
    for keys in choices:
        if keys and all(key in values for key in keys):
            return math.prod(values[key] for key in keys) ** (1.0 / len(keys)), keys
    return 0.0, ()
