"""The names and units with which laboratories label values: `B warp (gf.cm2/cm)`, `2HG5_gf_cm_mean`, `EMT-1 %`, `weight [g/m2]`, `bending rigidity weft`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NamedTuple

from garmentcad.fabric.fast import FAST_QUANTITIES, RATIO
from garmentcad.fabric.quantity import QUANTITIES, Quantity

FIT_QUANTITIES = QUANTITIES | FAST_QUANTITIES  # what a table for `fabric fit` may hold

_WORDS: dict[tuple[str, ...], str] = {
    **{(name.lower(),): name for name in FIT_QUANTITIES},
    ("mass", "per", "unit", "area"): "W",
    ("areal", "density"): "W",
    ("weight",): "W",
    ("thickness",): "T0",
    ("thickness", "tm"): "Tm",
    ("tensile", "linearity"): "LT",
    ("tensile", "energy"): "WT",
    ("tensile", "resilience"): "RT",
    ("tensile", "strain"): "EMT",
    ("extensibility",): "EMT",
    ("shear", "rigidity"): "G",
    ("shear", "stiffness"): "G",
    ("2hg", "0", "5"): "2HG",
    ("2hg", "0", "5", "deg"): "2HG",
    ("2hg", "5"): "2HG5",
    ("2hg", "5", "deg"): "2HG5",
    ("bending", "rigidity"): "B",
    ("bending", "stiffness"): "B",
    ("friction", "coefficient"): "MIU",
    ("coefficient", "of", "friction"): "MIU",
    ("geometrical", "roughness"): "SMD",
    ("bending", "length"): "C",
    ("bias", "extension"): "EB5",
    ("overhang", "length"): "overhang",
    ("cantilever", "length"): "overhang",
    ("2hb", "b"): RATIO,
}
# What laboratories call warp and weft; in knits wales run along the warp.
DIRECTIONS = {"warp": "warp", "wale": "warp", "wales": "warp", "1": "warp", "weft": "weft", "filling": "weft", "course": "weft", "courses": "weft", "2": "weft",
              "bias": "bias", "mean": "mean", "average": "mean", "avg": "mean"}  # fmt: skip
_NUMBERED = re.compile(r"(lt|wt|rt|emt|2hg5|2hg|2hb|b|g|c)([12])")  # B1, B2: the testers' numbers of warp and weft

_PER_RAD = math.pi / 180.0

# Units in which laboratories print a quantity -> factor to the testers'; read by their letters alone. A label without a unit is in the testers' unit.
_UNITS: dict[str, dict[str, float]] = {
    "-": {},
    "%": {"%": 1.0, "pct": 1.0, "percent": 1.0},
    "mg/cm2": {"mg/cm2": 1.0, "g/m2": 0.1, "gsm": 0.1},
    "mm": {"mm": 1.0, "cm": 10.0},
    "um": {"um": 1.0, "micron": 1.0},
    "gf/cm": {"gf/cm": 1.0, "N/m": 1.0 / 0.980665},
    "gf.cm/cm2": {"gf.cm/cm2": 1.0, "J/m2": 1.0 / 0.980665},
    # N/m alone is per radian, as FAST has G
    "gf/(cm.deg)": {
        "gf/(cm.deg)": 1.0, "gf/(cm.degree)": 1.0, "N/(m.deg)": 1.0 / 0.980665, "N/(m.rad)": _PER_RAD / 0.980665, "N/m": _PER_RAD / 0.980665,
    },
    "gf.cm2/cm": {"gf.cm2/cm": 1.0, "uN.m": 1.0 / 98.0665, "mN.m": 1e3 / 98.0665},
    "1/cm": {"1/cm": 1.0, "1/m": 0.01},
    "gf.cm/cm": {"gf.cm/cm": 1.0, "N": 1.0 / 9.80665e-3, "mN": 1e-3 / 9.80665e-3},
}  # fmt: skip
_BRACKETED = re.compile(r"(?P<label>.*)[\[(](?P<unit>[^\[\]]*)[\])]\s*")


class Label(NamedTuple):
    """What a label means: the key of the sheet, and the factor from the label's unit to the testers'."""

    key: str
    factor: float


class LabelParts(NamedTuple):
    """What a label says: its quantity, its direction ("" for none), and the letters of the rest: of a unit, none, or of what is not understood."""

    quantity: Quantity
    way: str
    rest: str


def label_words(text: str) -> list[str]:
    """Words of a label in small letters; exponents and the micro sign become plain letters, all punctuation separates."""
    plain = text.lower()
    for sign, letters in (("²", "2"), ("^2", "2"), ("µ", "u"), ("μ", "u"), ("°", " deg "), ("%", " % ")):
        plain = plain.replace(sign, letters)
    return [word for word in re.split(r"[^a-z0-9%]+", plain) if word]


_FACTORS = {quantity: {"": 1.0} | {"".join(label_words(unit)): factor for unit, factor in units.items()} for quantity, units in _UNITS.items()}


def label_parts(text: str, quantities: Mapping[str, Quantity]) -> LabelParts | None:
    """Parts of a label that names one of `quantities`, else None. Parts may be no good: a direction that the quantity does not have, a rest that is no unit."""
    words: list[str] = []
    for word in label_words(text):
        numbered = _NUMBERED.fullmatch(word) if word.upper() not in FIT_QUANTITIES else None
        words += [numbered[1], numbered[2]] if numbered else [word]
    found = [(start, -len(name), name) for name in _WORDS for start in range(len(words)) if tuple(words[start : start + len(name)]) == name]
    if not found:
        return None
    start, _, matched = min(found)  # the earliest, and of those the longest: the g of `weight g/m2` is a unit
    name = _WORDS[matched]
    words = [*words[:start], *words[start + len(matched) :]]
    if name not in quantities:
        return None
    quantity = quantities[name]
    way, rest = "", []
    for word in words:
        of_unit = word.isdigit() and not quantity.directions  # the 1 of 1/cm
        if not way and not of_unit and DIRECTIONS.get(word) in (quantity.directions or DIRECTIONS.values()):
            way = DIRECTIONS[word]
        elif word != name.lower():  # `bending rigidity B`
            rest.append(word)
    return LabelParts(quantity, way, "".join(rest))


def value_key(quantity: Quantity, way: str) -> str:
    """Key of the sheet; no direction is the mean."""
    return f"{quantity.name}.{way or 'mean'}" if quantity.directions else quantity.name


def unit_factor(unit: str, quantity: Quantity) -> float | None:
    """Factor from a unit to the testers', which is also that of no unit; None for what is no unit of the quantity."""
    return _FACTORS[quantity.unit].get("".join(label_words(unit)))


def read_label(text: str, quantities: Mapping[str, Quantity] = QUANTITIES) -> Label | None:
    """Meaning of a label among `quantities`, or None where any part of it is not understood (`B sd`, `DC %`, `B [lbf in]`)."""
    parts = label_parts(text, quantities)
    factor = None if parts is None else unit_factor(parts.rest, parts.quantity)
    if parts is None or factor is None or (parts.way and not parts.quantity.directions):
        return None
    return Label(value_key(parts.quantity, parts.way), factor)


def wrong_unit(unit: str, way: str, quantity: Quantity) -> str:
    """What to say of a unit that is none of the quantity."""
    return f"the unit {unit[:30]!r} for {value_key(quantity, way)}; allowed are {', '.join(_UNITS[quantity.unit]) or 'none'}"


def label_fault(text: str, quantities: Mapping[str, Quantity], way: str = "") -> str:
    """Why a label is not read. way: its direction, where that stands elsewhere."""
    match = _BRACKETED.fullmatch(text)
    parts = label_parts(match["label"] if match else text, quantities)
    if parts is not None and unit_factor(parts.rest, parts.quantity) is not None:
        if match and unit_factor(match["unit"], parts.quantity) is None:
            return wrong_unit(match["unit"], parts.way or way, parts.quantity)
        if parts.way and not parts.quantity.directions:
            return f"{parts.quantity.name} is one number without directions"
    return "a FAST value, of which `garmentcad fabric fit` makes a sheet" if read_label(text, FAST_QUANTITIES) else "not understood"
