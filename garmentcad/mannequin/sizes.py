"""Body sizes: a full set of tailor's measurements from the few that a user gives, by stated rules.

All rows are estimates where no source is cited. Women: a tailoring table by bust of the kind that W. Aldrich prints, as found in a public pattern repository;
its bust, waist and hip are those of EN 13402-3; heights are scaled so that nape to waist + waist to floor = 145 cm at stature 168 cm. Men: common proportion
(waist = chest - 12 cm, hip = chest + 2 cm). Girths and widths change with the bust (chest), lengths with the stature too.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Mapping, Sequence

from garmentcad.errors import MannequinError, did_you_mean

_TABLE: dict[str, dict[str, tuple[float, ...]]] = {  # mm by bust; between the columns linear, beyond them by the slope of the last two
    "woman": {
        "bust": (760, 800, 840, 880, 920, 960, 1000, 1040, 1100, 1160, 1220),
        "waist": (600, 640, 680, 720, 760, 800, 840, 880, 940, 1000, 1060),
        "hip": (840, 880, 920, 960, 1000, 1040, 1080, 1120, 1170, 1220, 1270),
        "neck_base": (340, 350, 360, 370, 380, 390, 400, 410, 424, 438, 452),
        "back_width": (314, 324, 334, 344, 354, 364, 374, 384, 398, 412, 426),
        "chest_front": (288, 300, 312, 324, 336, 348, 360, 372, 390, 408, 426),
        "shoulder": (115, 117.5, 120, 122.5, 125, 127.5, 130, 132.5, 136, 139, 142),
        "top_arm": (248, 260, 272, 284, 296, 308, 320, 332, 352, 372, 392),
        "wrist": (145, 150, 155, 160, 165, 170, 175, 180, 187, 194, 201),
        "armscye_depth": (198, 202, 206, 210, 214, 218, 222, 226, 232, 238, 244),
        "nape_to_waist": (398, 402, 406, 410, 414, 418, 422, 426, 430, 434, 438),
        "waist_to_floor": (1010, 1020, 1030, 1040, 1050, 1060, 1070, 1080, 1090, 1100, 1110),
        "waist_to_hip": (197, 200, 203, 206, 209, 212, 215, 218, 221, 224, 227),
        "waist_to_knee": (570, 575, 580, 585, 590, 595, 600, 605, 610, 615, 620),
        "body_rise": (259, 266, 273, 280, 287, 294, 301, 308, 318, 328, 338),
        "arm_length": (570, 575, 580, 585, 590, 595, 600, 602.5, 605, 607.5, 610),
    },
    "man": {
        "bust": (960, 1000),
        "waist": (840, 880),
        "hip": (980, 1020),
        "neck_base": (400, 410),
        "back_width": (390, 400),
        "chest_front": (358, 370),
        "shoulder": (147.5, 150),
        "top_arm": (308, 320),
        "wrist": (170, 175),
        "armscye_depth": (231, 235),
        "nape_to_waist": (446, 446),
        "waist_to_floor": (1090, 1090),
        "waist_to_hip": (220, 220),
        "waist_to_knee": (600, 600),
        "body_rise": (280, 280),
        "arm_length": (640, 640),
    },
}  # fmt: skip
_LENGTHS = ("nape_to_waist", "waist_to_floor", "waist_to_hip", "waist_to_knee", "body_rise", "arm_length")
_BASE = {"woman": (880.0, 1680.0), "man": (1000.0, 1780.0)}  # bust and stature of the base sizes, mm
_THIGH_PER_HIP = {"woman": 0.59, "man": 0.57}
_BY_RULE = (0.6, 1.5)  # of what the rule gives for a measurement, that may be given for it: estimates
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
    bust, stature = float(given["bust"]), float(given.get("stature", _BASE[kind][1]))
    row = {name: _between(_TABLE[kind]["bust"], column, bust) for name, column in _TABLE[kind].items()}
    standing = sum(_TABLE[kind][name][_TABLE[kind]["bust"].index(_BASE[kind][0])] for name in ("nape_to_waist", "waist_to_floor"))
    scale = stature / _BASE[kind][1] * (standing / (row["nape_to_waist"] + row["waist_to_floor"]))
    rule = {name: value * scale if name in _LENGTHS else value for name, value in row.items()} | {"stature": stature}
    sizes = {name: float(given.get(name, value)) for name, value in rule.items()}
    sizes["thigh"] = float(given.get("thigh", _THIGH_PER_HIP[kind] * sizes["hip"]))
    _check(sizes, rule)
    return {name: sizes[name] for name in GIVEN}


def _between(places: Sequence[float], values: Sequence[float], at: float) -> float:
    """Linear between the places, and beyond them by the slope of the last two."""
    k = min(max(bisect.bisect_right(places, at) - 1, 0), len(places) - 2)
    return values[k] + (at - places[k]) / (places[k + 1] - places[k]) * (values[k + 1] - values[k])


def base_sizes(kind: str) -> dict[str, float]:
    """Measurements of the size from which the others of a kind are graded (woman-88, man-100)."""
    return full_sizes(kind, {"bust": _BASE[kind][0]})


def _check(sizes: Mapping[str, float], rule: Mapping[str, float]) -> None:
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
    for name in ("back_width", "chest_front", "shoulder", "armscye_depth", "waist_to_hip"):
        low, high = (edge * rule[name] for edge in _BY_RULE)
        if not low <= sizes[name] <= high:
            message = f"{sizes[name]:g} mm does not go with the other measurements, by which it would be {rule[name]:.0f} mm; {low:.0f} to {high:.0f} mm do"
            raise MannequinError(message, key=f"measurements.{name}")
