"""Findings on set-in sleeves: the cap against the armhole."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from garmentcad.check.finding import Finding
from garmentcad.pattern.pattern import EdgeUse, Pattern, Wrap
from garmentcad.pattern.runs import side_length

# A cap is never shorter than its armhole (emmakespatterns.com, sleeve cap ease); textbooks ease in 1 to 1 1/2 inches, Armstrong's Patternmaking for Fashion
# Design 1 1/2 on average (designloft.blogspot.com, March 2008). 5 mm on either side are what cutting and sewing vary by, an estimate.
_EASE_MM = (-5.0, 38.0 + 5.0)
_GATHERED = 0.10  # a seam that says so is a gathered cap, which may have any ease


def check_sleeves(pattern: Pattern, file: str | None) -> Iterator[Finding]:
    """The caps of the panels wrapped on each arm against what they are sewn to on the trunk."""
    caps: defaultdict[str, float] = defaultdict(float)
    armholes: defaultdict[str, float] = defaultdict(float)
    seams: defaultdict[str, list[str]] = defaultdict(list)
    for seam in pattern.seams:
        arm_a, arm_b = _arm(pattern, seam.a), _arm(pattern, seam.b)
        if bool(arm_a) == bool(arm_b) or abs(seam.ease) >= _GATHERED:
            continue
        arm = arm_a or arm_b
        caps[arm] += side_length(pattern, seam.a if arm_a else seam.b)
        armholes[arm] += side_length(pattern, seam.b if arm_a else seam.a)
        seams[arm].append(seam.name)
    for arm, cap in caps.items():
        ease, (low, high) = cap - armholes[arm], _EASE_MM
        if not low <= ease <= high:
            yield Finding(
                "warning", "sleeve-cap", file, f"seams.{seams[arm][0]}",
                f"the sleeve cap is {cap:.0f} mm long and the armhole {armholes[arm]:.0f} mm ({', '.join(seams[arm])}): {ease:+.0f} mm; "
                f"{low:.0f} to {high:.0f} mm can be eased in",
                "Raise or widen the cap, or cut the armhole shallower." if ease < low
                else f"Lower the cap or deepen the armhole; say ease: {_GATHERED:g} or more on the seam if it shall be gathered.",
            )  # fmt: skip


def _arm(pattern: Pattern, side: tuple[EdgeUse, ...]) -> str:
    """The arm on which the panels of a side are wrapped; empty where one is not."""
    rules = [pattern.panels[use.panel].placement for use in side]
    parts = {rule.part if isinstance(rule, Wrap) else "" for rule in rules}
    part = parts.pop()
    return part if not parts and part.startswith("arm_") else ""
