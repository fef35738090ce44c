"""Material table: one row per fabric (or per region of a fabric with factors), SI, as arrays that kernels read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats
from garmentcad.errors import FabricError
from garmentcad.fabric import law_shear
from garmentcad.fabric.fused import fused
from garmentcad.fabric.law_tension import friction_share, initial_slope, solve_exponent, strain_at_force
from garmentcad.fabric.law_values import law_numbers
from garmentcad.fabric.sheet import KesSheet
from garmentcad.units import GF_CM2_CM_TO_N_M, GF_CM_CM_TO_N, GF_CM_DEG_TO_N_M_RAD, GF_CM_TO_N_M, MG_CM2_TO_KG_M2, MM_TO_M

BODY_FRICTION = 1.0  # times MIU; both factors are estimates: MIU is measured against a steel wire
CLOTH_FRICTION = 1.3
STRAIN_LIMIT_FORCE = 1.5  # times Fm


class MaterialTable(NamedTuple):
    """Rows of law values. Column 0 is warp, 1 is weft where a second axis stands."""

    areal_mass: np.ndarray  # (M,) kg/m2
    tension_strain: np.ndarray  # (M,2) em = EMT/100 at Fm
    tension_force: np.ndarray  # (M,2) Fm, N/m
    tension_exponent: np.ndarray  # (M,2) x of F = Fm (exp(x u) - 1)/(exp(x) - 1), u = e/em; 0 is linear
    tension_slope: np.ndarray  # (M,2) initial slope of that curve, N/m: law_tension.initial_slope
    tension_friction: np.ndarray  # (M,2) c, half of what the way back lacks: law_tension.friction_share
    strain_limit: np.ndarray  # (M,2) strain at 1.5 Fm
    shear: np.ndarray  # (M,) G_e = G - (2HG5 - 2HG)/(2 x 4.5 degrees), N/m per rad
    shear_friction: np.ndarray  # (M,2) H below 0.5 and above 5 degrees: 2HG/2, 2HG5/2, N/m
    shear_way: np.ndarray  # (M,) d of the stick spring, rad
    bending: np.ndarray  # (M,2) N.m
    bending_friction: np.ndarray  # (M,2) H = 2HB/2, N
    twist: np.ndarray  # (M,) D66 = max(0, B_bias - (B_warp + B_weft)/4), N.m
    twist_friction: np.ndarray  # (M,) max(0, 2 H_bias - H_warp - H_weft), N
    thickness: np.ndarray  # (M,) T0, m
    friction_body: np.ndarray  # (M,) fabric on body
    friction_cloth: np.ndarray  # (M,) fabric on fabric


class MaterialRow(NamedTuple):
    """One row of the material table; pairs are (warp, weft). Units as in `MaterialTable`."""

    areal_mass: float
    tension_strain: tuple[float, float]
    tension_force: tuple[float, float]
    tension_exponent: tuple[float, float]
    tension_slope: tuple[float, float]
    tension_friction: tuple[float, float]
    strain_limit: tuple[float, float]
    shear: float
    shear_friction: tuple[float, float]
    shear_way: float
    bending: tuple[float, float]
    bending_friction: tuple[float, float]
    twist: float
    twist_friction: float
    thickness: float
    friction_body: float
    friction_cloth: float


def material_row(sheet: KesSheet, factors: Mapping[str, float] | None = None, interfacing: KesSheet | None = None) -> MaterialRow:
    """Law values of a completed sheet (calibrated ones where it carries them), each KES value times its factor; `interfacing` then adds its own (fused.py).

    FabricError as in `law_numbers` and `fused`, or for an RT above 100 %.
    """
    numbers = law_numbers(sheet, factors) if interfacing is None else law_numbers(fused(sheet, interfacing, factors))
    value = numbers.__getitem__

    def both(name: str) -> tuple[float, float]:
        return value(f"{name}.warp"), value(f"{name}.weft")

    force = value("Fm") * GF_CM_TO_N_M
    strain_warp, strain_weft = (percent / 100.0 for percent in both("EMT"))
    exponent_warp, exponent_weft = (solve_exponent(linearity) for linearity in both("LT"))
    bend_warp, bend_weft = (stiffness * GF_CM2_CM_TO_N_M for stiffness in both("B"))
    hold_warp, hold_weft, hold_bias = (0.5 * value(f"2HB.{way}") * GF_CM_CM_TO_N for way in ("warp", "weft", "bias"))
    slope, narrow, wide = (0.5 * sum(both(name)) for name in ("G", "2HG", "2HG5"))
    elastic = law_shear.elastic_slope(slope, narrow, wide, sheet.shear_window_deg) * GF_CM_DEG_TO_N_M_RAD
    low, high = 0.5 * narrow * GF_CM_TO_N_M, 0.5 * wide * GF_CM_TO_N_M
    resilience = both("RT")
    if max(resilience) > 100.0:
        raise FabricError(f"RT = {max(resilience):g} % with its factors; at most 100 % of the energy can be given back", key="factors.RT")
    return MaterialRow(
        areal_mass=value("W") * MG_CM2_TO_KG_M2,
        tension_strain=(strain_warp, strain_weft),
        tension_force=(force, force),
        tension_exponent=(exponent_warp, exponent_weft),
        tension_slope=(float(initial_slope(strain_warp, force, exponent_warp)), float(initial_slope(strain_weft, force, exponent_weft))),
        tension_friction=(friction_share(0.01 * resilience[0], exponent_warp), friction_share(0.01 * resilience[1], exponent_weft)),
        strain_limit=(
            strain_at_force(STRAIN_LIMIT_FORCE * force, strain_warp, force, exponent_warp),
            strain_at_force(STRAIN_LIMIT_FORCE * force, strain_weft, force, exponent_weft),
        ),
        shear=elastic,
        shear_friction=(low, high),
        shear_way=law_shear.stick_way(low, high, elastic),
        bending=(bend_warp, bend_weft),
        bending_friction=(hold_warp, hold_weft),
        twist=max(0.0, value("B.bias") * GF_CM2_CM_TO_N_M - 0.25 * (bend_warp + bend_weft)),
        twist_friction=max(0.0, 2.0 * hold_bias - hold_warp - hold_weft),
        thickness=value("T0") * MM_TO_M,
        friction_body=value("MIU.mean") * BODY_FRICTION,
        friction_cloth=value("MIU.mean") * CLOTH_FRICTION,
    )


def material_table(rows: Sequence[MaterialRow]) -> MaterialTable:
    """Rows as arrays for kernels, in the order given. FabricError for no rows."""
    if not rows:
        raise FabricError("a material table needs at least one row")
    return MaterialTable(*(floats(column) for column in zip(*rows, strict=True)))


def softened(materials: MaterialTable, softness: float) -> MaterialTable:
    """The same with tension, and the friction of shear, divided by `softness`: what is stiff in the plane, and decides the time step. Strains mean the same.

    Tension has no friction while it is softer than the cloth's: it strains too far then, and friction would keep some of that.
    """
    parts = {name: getattr(materials, name) / softness for name in ("tension_force", "tension_slope", "shear_friction")}
    if softness != 1.0:
        parts["tension_friction"] = 0.0 * materials.tension_friction
    return materials._replace(**parts)


def without_friction(materials: MaterialTable) -> MaterialTable:
    """The same without internal friction: elastic, with the same elastic curves."""
    return materials._replace(**{name: 0.0 * getattr(materials, name) for name in ("tension_friction", "shear_friction", "bending_friction", "twist_friction")})


def bending_along(materials: MaterialTable, material: np.ndarray, along_warp: np.ndarray) -> np.ndarray:
    """Bending stiffness [N.m] in a direction of rows `material` (any shape), from its cosine to warp: B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2.

    Source: orthotropic plate without Poisson effect.
    """
    warp2 = along_warp**2
    weft2 = 1.0 - warp2
    bending = materials.bending[material]
    return np.asarray(bending[..., 0] * warp2**2 + bending[..., 1] * weft2**2 + 4.0 * materials.twist[material] * warp2 * weft2)


def bending_friction_along(materials: MaterialTable, material: np.ndarray, along_warp: np.ndarray) -> np.ndarray:
    """H [N] of bending in a direction of rows `material`, from its cosine c to warp: H_warp c^2 + H_weft s^2 + H_twist |c s|, what a bend by kappa loses
    over all three, which then bend by c^2, s^2 and c s kappa."""
    warp2 = along_warp**2
    friction = materials.bending_friction[material]
    return np.asarray(friction[..., 0] * warp2 + friction[..., 1] * (1.0 - warp2) + materials.twist_friction[material] * np.sqrt(warp2 * (1.0 - warp2)))
