"""The values of a KES sheet: meaning, unit as the testers print it, and the ranges that are believed.

Outside the *possible* range a value is refused: it is a slip of unit or decimal point. Outside the *usual* range it gives a finding.
Usual ranges of W and B: percentiles 5 and 95 of 618 fabrics measured by Feng et al. 2022, rounded outward. The others span the measured sheets this
project knows (suitings, denims, shirtings) with a margin, estimates.
"""

from __future__ import annotations

from typing import NamedTuple

from garmentcad.errors import FabricError, did_you_mean


class Quantity(NamedTuple):
    """One printed value. directions: the entries it may have (none for a value of the whole fabric)."""

    name: str
    unit: str
    meaning: str
    possible: tuple[float, float]
    usual: tuple[float, float]
    directions: tuple[str, ...] = ()
    slip: str = ""  # what an impossible number probably was


WAYS = ("warp", "weft", "mean")
BENDING_WAYS = ("warp", "weft", "bias", "mean")

QUANTITIES: dict[str, Quantity] = {
    q.name: q
    for q in (
        Quantity("W", "mg/cm2", "mass per area", (1.0, 90.0), (3.0, 50.0), slip="1 mg/cm2 is 10 g/m2: divide g/m2 by 10"),
        Quantity("T0", "mm", "thickness at 0.5 gf/cm2", (0.03, 10.0), (0.1, 2.0), slip="thickness is in millimetres"),
        Quantity("Tm", "mm", "thickness at 50 gf/cm2", (0.02, 10.0), (0.08, 1.8), slip="thickness is in millimetres"),
        Quantity("Fm", "gf/cm", "largest force of the tensile test", (10.0, 1000.0), (50.0, 500.0), slip="1 gf/cm is 0.980665 N/m; usual is 500"),
        Quantity("LT", "-", "linearity of the tensile curve", (0.15, 1.6), (0.4, 1.1), WAYS),
        Quantity("WT", "gf.cm/cm2", "tensile energy up to Fm", (0.05, 300.0), (1.0, 40.0), WAYS),
        Quantity("RT", "%", "tensile resilience, energy given back", (5.0, 100.0), (35.0, 85.0), WAYS, "RT is printed in percent"),
        Quantity("EMT", "%", "strain at Fm", (0.2, 150.0), (1.0, 40.0), WAYS, "EMT is printed in percent"),
        Quantity("G", "gf/(cm.deg)", "shear stiffness", (0.02, 20.0), (0.15, 5.0), WAYS, "1 gf/(cm.deg) is 56.19 N/m per rad"),
        Quantity("2HG", "gf/cm", "shear hysteresis at 0.5 degrees", (0.0, 60.0), (0.1, 10.0), WAYS),
        Quantity("2HG5", "gf/cm", "shear hysteresis at 5 degrees", (0.0, 80.0), (0.2, 15.0), WAYS),
        Quantity("B", "gf.cm2/cm", "bending stiffness", (0.0005, 20.0), (0.009, 1.2), BENDING_WAYS, "1 gf.cm2/cm is 98.07 uN.m"),
        Quantity("2HB", "gf.cm/cm", "bending hysteresis at 1 /cm", (0.0, 20.0), (0.003, 1.2), BENDING_WAYS),
        Quantity("MIU", "-", "friction coefficient against the steel wire", (0.02, 1.5), (0.1, 0.4), WAYS),
        Quantity("MMD", "-", "mean deviation of MIU", (0.0, 0.5), (0.002, 0.1), WAYS),
        Quantity("SMD", "um", "geometrical roughness", (0.0, 100.0), (0.5, 20.0), WAYS),
        Quantity("LC", "-", "linearity of the compression curve", (0.05, 1.5), (0.2, 0.6)),
        Quantity("WC", "gf.cm/cm2", "compression energy", (0.001, 10.0), (0.02, 1.0)),
        Quantity("RC", "%", "compression resilience", (1.0, 100.0), (20.0, 80.0), (), "RC is printed in percent"),
    )
}

KEYS: tuple[str, ...] = tuple(key for q in QUANTITIES.values() for key in ([q.name] if not q.directions else [f"{q.name}.{way}" for way in q.directions]))


def quantity_of(key: str) -> Quantity:
    """Quantity of a key (`B.weft`, `W`) or of a bare name (`B`). FabricError with a suggestion for an unknown one."""
    name, dot, way = key.partition(".")
    quantity = QUANTITIES.get(name)
    if quantity is None:
        raise FabricError(f"{key[:100]!r} is not a value of a KES sheet{did_you_mean(name, QUANTITIES)}", key=key[:100])
    if dot and way not in quantity.directions:
        raise FabricError(f"{name} has no direction {way[:100]!r}{did_you_mean(way, quantity.directions)}", key=key[:100])
    return quantity
