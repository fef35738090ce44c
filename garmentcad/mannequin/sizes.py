"""Body sizes: a full set of tailor's measurements from the few that a user gives, by stated rules.

The rows are estimates until a source is cited: women's from a tailoring table by bust (sum nape to waist + waist to floor = 145 cm at stature 168 cm),
men's by common proportion. Girths and widths change with the bust (chest), lengths with the stature.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from garmentcad.errors import MannequinError, did_you_mean

# name: (value at the row's bust and stature, change in mm per mm of bust), mm
_GIRTHS = {
    "woman": {
        "waist": (720.0, 1.0), "hip": (960.0, 1.0), "neck_base": (370.0, 0.25), "back_width": (344.0, 0.25), "chest_front": (324.0, 0.30),
        "shoulder": (122.5, 0.0625), "top_arm": (284.0, 0.30), "wrist": (160.0, 0.125), "armscye_depth": (210.0, 0.10),
    },
    "man": {
        "waist": (880.0, 1.0), "hip": (1020.0, 1.0), "neck_base": (410.0, 0.25), "back_width": (400.0, 0.25), "chest_front": (370.0, 0.30),
        "shoulder": (150.0, 0.0625), "top_arm": (320.0, 0.30), "wrist": (175.0, 0.125), "armscye_depth": (235.0, 0.10),
    },
}  # fmt: skip
_LENGTHS = {
    "woman": {"nape_to_waist": 410.0, "waist_to_floor": 1040.0, "waist_to_hip": 206.0, "waist_to_knee": 585.0, "body_rise": 280.0, "arm_length": 585.0},
    "man": {"nape_to_waist": 446.0, "waist_to_floor": 1090.0, "waist_to_hip": 220.0, "waist_to_knee": 600.0, "body_rise": 280.0, "arm_length": 640.0},
}  # fmt: skip
_BASE = {"woman": (880.0, 1680.0), "man": (1000.0, 1780.0)}  # bust and stature of the base sizes, mm
_THIGH_PER_HIP = {"woman": 0.59, "man": 0.57}
_RANGES = {"bust": (700.0, 1400.0), "waist": (500.0, 1400.0), "hip": (700.0, 1500.0), "stature": (1400.0, 2100.0)}

GIVEN = ("bust", "waist", "hip", "stature", "neck_base", "back_width", "chest_front", "shoulder", "armscye_depth", "nape_to_waist", "waist_to_hip",
         "waist_to_knee", "waist_to_floor", "body_rise", "top_arm", "wrist", "arm_length", "thigh")  # fmt: skip


def full_sizes(kind: str, given: Mapping[str, float]) -> dict[str, float]:
    """All measurements of GIVEN in mm: those given, the others by rule. `kind` is woman or man; bust alone is a must.

    MannequinError for unknown names, values that are not finite numbers, or lie outside what a grown body has.
    """
    if kind not in _BASE:
        raise MannequinError(f"{kind!r} is not a kind of body; allowed: {', '.join(_BASE)}", key="kind")
    for name, value in given.items():
        if name not in GIVEN:
            raise MannequinError(f"{name!r} is not a measurement{did_you_mean(name, GIVEN)}", key="measurements")
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise MannequinError(f"{value!r} is not a number of mm", key=f"measurements.{name}")
    if "bust" not in given:
        raise MannequinError("the bust (chest) girth is missing", key="measurements.bust")
    bust, stature = _BASE[kind]
    more = given["bust"] - bust
    sizes = {"bust": float(given["bust"]), "stature": float(given.get("stature", stature))}
    for name, (value, grade) in _GIRTHS[kind].items():
        sizes[name] = float(given.get(name, value + grade * more))
    for name, value in _LENGTHS[kind].items():
        sizes[name] = float(given.get(name, value * sizes["stature"] / stature))
    sizes["thigh"] = float(given.get("thigh", _THIGH_PER_HIP[kind] * sizes["hip"]))
    _check(sizes)
    return {name: sizes[name] for name in GIVEN}


def base_sizes(kind: str) -> dict[str, float]:
    """Measurements of the size from which the others of a kind are graded (woman-88, man-100)."""
    return full_sizes(kind, {"bust": _BASE[kind][0]})


def _check(sizes: Mapping[str, float]) -> None:
    for name, (low, high) in _RANGES.items():
        if not low <= sizes[name] <= high:
            raise MannequinError(f"{sizes[name]:g} mm is outside {low:g} to {high:g} mm (are the values in mm?)", key=f"measurements.{name}")
    standing = sizes["nape_to_waist"] + sizes["waist_to_floor"]
    if not 0.80 <= standing / sizes["stature"] <= 0.90:
        raise MannequinError(
            f"nape to waist + waist to floor = {standing:g} mm must be 80 to 90 % of the stature {sizes['stature']:g} mm", key="measurements.stature"
        )
    steps = {"waist_to_hip": (0.0, "body_rise"), "body_rise": (30.0, "waist_to_knee"), "waist_to_knee": (100.0, "waist_to_floor")}
    for name, (gap, below) in steps.items():
        if sizes[name] <= 0 or sizes[name] + gap >= sizes[below]:
            raise MannequinError(f"{name} {sizes[name]:g} mm must be positive and below {below} {sizes[below]:g} mm", key=f"measurements.{name}")
    shares = (("neck_base", "bust", 0.42), ("top_arm", "bust", 0.33), ("wrist", "bust", 0.18), ("thigh", "hip", 0.59), ("arm_length", "stature", 0.35))
    for name, reference, share in shares:
        low, high = (edge * share * sizes[reference] for edge in (0.75, 1.25))
        if not low <= sizes[name] <= high:
            message = f"{sizes[name]:g} mm does not go with {reference} {sizes[reference]:g} mm; {low:.0f} to {high:.0f} mm do"
            raise MannequinError(message, key=f"measurements.{name}")
    for name in ("back_width", "chest_front", "shoulder", "armscye_depth"):
        if not 50.0 <= sizes[name] <= 600.0:
            raise MannequinError(f"{sizes[name]:g} mm is outside 50 to 600 mm", key=f"measurements.{name}")
