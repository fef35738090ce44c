"""Assertions on the values of a report: which value a key means, and whether it is what a test expects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.pattern.garment_test import ANY, Expected, Tolerance
from garmentcad.pattern.parse import shown


@dataclass(frozen=True)
class Verdict:
    """One assertion and what became of it. expected, came: as people read them."""

    key: str
    expected: str
    came: str
    passed: bool


def refuse_unknown_keys(keys: Iterable[str], blank: Mapping[str, Any], file: str, place: str) -> None:
    """SpecError for a key that no report has, or that stands for a group of values. blank: `blank_report()`; in a mapping that it leaves empty any name is
    allowed."""
    for key in keys:
        nodes: list[Any] = [blank]
        for depth, name in enumerate(key.split(".")):
            groups = [node for node in nodes if isinstance(node, Mapping)]
            if not all(groups):
                break
            nodes = [value for node in groups for known, value in node.items() if fnmatchcase(known, name)]
            if not nodes:
                where = f"in {'.'.join(key.split('.')[:depth])}" if depth else "in a report"
                message = f"there is no {shown(name)} {where}{did_you_mean(name, {known for node in groups for known in node})}"
                raise SpecError(message, file=file, key=f"{place}.{key}")
        else:
            if all(isinstance(node, Mapping) and node for node in nodes):
                raise SpecError(f"this is a group of values; name one of them or write {key}.*", file=file, key=f"{place}.{key}")


def values_at(report: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Path -> value of all that a key means in a report. Values that were not measured (None) are left out where the key has a wildcard."""
    found: dict[str, Any] = {"": report}
    for name in key.split("."):
        found = {
            f"{path}.{known}".lstrip("."): value
            for path, node in found.items()
            if isinstance(node, Mapping)
            for known, value in node.items()
            if fnmatchcase(known, name)
        }
    return {path: value for path, value in found.items() if value is not None} if ANY in key else found


def means(reports: Sequence[Mapping[str, Any]], key: str) -> dict[str, Any]:
    """Path -> mean over reports of each value that a key means; None where one report has no number there."""
    found = [values_at(report, key) for report in reports]
    if len(found) == 1:
        return found[0]
    return {path: _mean([values.get(path) for values in found]) for path in found[0]}


def _mean(values: list[Any]) -> float | None:
    numbers = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
    return sum(numbers) / len(numbers) if len(numbers) == len(values) else None


def judge(report: Mapping[str, Any], expected: Mapping[str, Expected]) -> list[Verdict]:
    """A verdict for each value that each key means; one that fails for a key that means none."""
    verdicts = []
    for key, wanted in expected.items():
        values = values_at(report, key)
        verdicts += [Verdict(path, expected_text(wanted), came_text(value), holds(value, wanted)) for path, value in values.items()]
        if not values:
            verdicts.append(Verdict(key, expected_text(wanted), "no such value", False))
    return verdicts


def holds(value: Any, wanted: Expected) -> bool:
    """Whether a value of a report is what is expected (see `garment_test`)."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if isinstance(wanted, Tolerance):
        return number and abs(value - wanted.value) <= wanted.tol
    if isinstance(wanted, tuple):
        low, high = wanted
        return number and (low is None or value >= low) and (high is None or value <= high)
    if wanted == ANY:
        return value is not None
    return bool(value == wanted) and isinstance(value, bool) == isinstance(wanted, bool)


def expected_text(wanted: Expected) -> str:
    """What is expected, as people write it."""
    if isinstance(wanted, Tolerance):
        return f"{wanted.value:.6g} ± {wanted.tol:.3g}"
    if isinstance(wanted, tuple):
        low, high = wanted
        return f"{low:.6g} to {high:.6g}" if low is not None and high is not None else f"at most {high:.6g}" if low is None else f"at least {low:.6g}"
    return "any value" if wanted == ANY else came_text(wanted)


def came_text(value: Any) -> str:
    """A value of a report on one short line."""
    if value is None:
        return "not measured"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    return value if isinstance(value, str) and len(value) <= 80 else shown(value)
