"""The rules for missing values against fabrics that were measured: what a rule would have said, over what the laboratory printed.

`python -m tools.rule_study` writes docs/studies/fabric-rules.md from docs/studies/measured-fabrics.csv.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from garmentcad.fabric.missing import RULES, Rule
from garmentcad.fabric.sheet import KesSheet
from garmentcad.io.atomic import write_atomic
from garmentcad.io.kes_csv import read_kes_csv

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
BY_DEFINITION = ("equal to", "2 mean", "200 WT", "LT Fm", "mean of", "500 gf/cm")  # rules that hand a number on or hold by definition
INTRO = """# Rules for missing values against measured fabrics

Each rule of `garmentcad/fabric/missing.py` that estimates, on every measured fabric that has both the value and what the rule needs
(`measured-fabrics.csv`, with sources). Ratio: the rule's number over the measured one; half of the fabrics lie between the quartiles.
A value printed as the mean of warp and weft counts once.

"""


class Check(NamedTuple):
    """A rule and its ratios to what was measured."""

    rule: Rule
    ratios: np.ndarray


def measured(sheet: KesSheet) -> dict[str, float]:
    """Numbers of a sheet; a printed mean stands for the warp and, where a rule wants it, the weft."""
    numbers = {key: value.value for key, value in sheet.values().items()}
    for key, number in list(numbers.items()):
        name, _, way = key.partition(".")
        if way == "mean":
            numbers.setdefault(f"{name}.warp", number)
    return numbers


def check_rules(fabrics: Mapping[str, dict[str, float]]) -> list[Check]:
    """Ratios of every rule that estimates; rules that differ only in their direction count together."""
    found: dict[str, Check] = {}
    for rule in RULES:
        if rule.text.startswith(BY_DEFINITION):
            continue
        ratios = [
            rule.formula(*(numbers[need] for need in rule.needs)) / numbers[rule.key]
            for numbers in fabrics.values()
            if rule.key in numbers and all(need in numbers for need in rule.needs)
        ]
        label = f"{rule.key.partition('.')[0]} {rule.text}"
        earlier = found[label].ratios if label in found else np.array([])
        found[label] = Check(rule, np.concatenate((earlier, ratios)))
    return [check for check in found.values() if len(check.ratios)]


def page(checks: list[Check]) -> str:
    """The table as Markdown."""
    lines = ["| value | rule | fabrics | median ratio | quartiles | range |", "|---|---|---|---|---|---|"]
    for rule, ratios in checks:
        low, middle, high = np.percentile(ratios, (25, 50, 75))
        name = rule.key.partition(".")[0] if rule.key.endswith((".warp", ".weft", ".mean")) and rule.key[0] != "B" else rule.key
        lines.append(f"| `{name}` | {rule.text} | {len(ratios)} | {middle:.2f} | {low:.2f} to {high:.2f} | {ratios.min():.2f} to {ratios.max():.2f} |")
    return INTRO + "Made by `python -m tools.rule_study`.\n\n" + "\n".join(lines) + "\n"


def main() -> None:
    sheets, _ = read_kes_csv(FOLDER / "measured-fabrics.csv")
    text = page(check_rules({sheet.name: measured(sheet) for sheet in sheets}))
    write_atomic(FOLDER / "fabric-rules.md", text)
    print(text)


if __name__ == "__main__":
    main()
