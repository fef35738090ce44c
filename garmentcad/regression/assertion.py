"""Assertions on the values of a report: which value a key means, and whether it is what a test expects."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.export.report import SIGNIFICANT_DIGITS
from garmentcad.pattern.garment_test import ANY, Expected, Tolerance
from garmentcad.pattern.parse import shown

_DIGITS = 6  # of a value that is as expected


@dataclass(frozen=True)
class Verdict:
    """One assertion and what became of it. expected, came: as people read them."""

    key: str
    expected: str
    came: str
    passed: bool


def refuse_unknown_keys(keys: Iterable[str], known: Mapping[str, Any], file: str, place: str) -> None:
    """SpecError for a key that the report will not have, or that stands for a group of values. known: see `known_values`."""
    for key in keys:
        names = key.split(".")
        reached: list[list[Any]] = [[known], *([] for _ in names)]  # what the first names of the key lead to, by how many they are
        for depth, nodes in enumerate(reached):
            for node in nodes:
                for _, value, taken in _meant(node, names[depth:]):
                    reached[depth + taken].append(value)
        if not reached[-1]:
            depth = max(depth for depth, nodes in enumerate(reached) if nodes)
            allowed = {name for node in reached[depth] if isinstance(node, Mapping) for name in node}
            longest = 1 + max((name.count(".") for name in allowed), default=0)
            unknown = ".".join(names[depth : depth + longest])
            where = f"in {'.'.join(names[:depth])}" if depth else "in a report"
            raise SpecError(f"there is no {shown(unknown)} {where}{did_you_mean(unknown, allowed)}", file=file, key=f"{place}.{key}")
        if all(isinstance(value, Mapping) for value in reached[-1]):
            raise SpecError(f"this is a group of values; name one of them or write {key}.*", file=file, key=f"{place}.{key}")


def values_at(report: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Path -> value of all that a key means in a report. Values that were not measured (None) are left out where the key has a wildcard."""
    found = {".".join(path): value for path, value in _below(report, key.split("."))}
    return {path: value for path, value in found.items() if value is not None} if ANY in key else found


def _below(node: Any, names: list[str]) -> Iterator[tuple[tuple[str, ...], Any]]:
    if not names:
        yield (), node
    for name, value, taken in _meant(node, names):
        for path, found in _below(value, names[taken:]):
            yield (name, *path), found


def _meant(node: Any, names: list[str]) -> Iterator[tuple[str, Any, int]]:
    """Each entry of a mapping that the first names of a key mean, and how many of them that takes: the garment's own names (`panel.fold`) have dots, too."""
    if isinstance(node, Mapping):
        for name, value in node.items():
            for taken in range(1, min(len(names), 1 + name.count(".")) + 1):
                if _like(name, ".".join(names[:taken])):
                    yield name, value, taken


def _like(name: str, wanted: str) -> bool:
    """Whether a name is the wanted one, in which ANY stands for any text."""
    return re.fullmatch(".*".join(map(re.escape, wanted.split(ANY))), name, re.DOTALL) is not None


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
    verdicts: dict[str, Verdict] = {}
    for key, wanted in expected.items():
        values = values_at(report, key)
        for path, value in values.items():
            name = f"{path} ({key})" if path in verdicts else path  # servers that read JUnit XML take two cases of one name for one
            verdicts[name] = verdict(name, value, wanted)
        if not values:
            verdicts[key] = Verdict(key, expected_text(wanted), "no such value", False)
    return list(verdicts.values())


def verdict(key: str, value: Any, wanted: Expected) -> Verdict:
    """The verdict on one value. What fails is told with all the digits of a report: it may lie a billionth beside what it should be."""
    passed = holds(value, wanted)
    digits = _DIGITS if passed else SIGNIFICANT_DIGITS
    return Verdict(key, expected_text(wanted, digits), came_text(value, digits), passed)


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


def expected_text(wanted: Expected, digits: int = _DIGITS) -> str:
    """What is expected, as people write it."""
    if isinstance(wanted, Tolerance):
        return f"{wanted.value:.{digits}g} ± {wanted.tol:.3g}"
    if isinstance(wanted, tuple):
        low, high = (None if bound is None else f"{bound:.{digits}g}" for bound in wanted)
        return f"{low} to {high}" if low is not None and high is not None else f"at most {high}" if low is None else f"at least {low}"
    return "any value" if wanted == ANY else came_text(wanted, digits)


def came_text(value: Any, digits: int = _DIGITS) -> str:
    """A value of a report on one short line."""
    if value is None:
        return "not measured"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    return value if isinstance(value, str) and len(value) <= 80 else shown(value)
