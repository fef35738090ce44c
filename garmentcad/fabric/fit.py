"""From what a laboratory has (loops of the testers, FAST readings, a cantilever length, printed values) to a sheet with bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from garmentcad.errors import FabricError
from garmentcad.fabric.fast import FAST_QUANTITIES, doubtful, fit_fast
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.fit_friction import fit_friction, unread
from garmentcad.fabric.fit_tension import doubtful_starts, fit_tension
from garmentcad.fabric.fitted import FittedValue, fitted_sheet
from garmentcad.fabric.given import Given
from garmentcad.fabric.missing import USUAL_FM, complete, noticed
from garmentcad.fabric.recorded_loop import RecordedLoop
from garmentcad.fabric.sheet import KesSheet


class Fit(NamedTuple):
    """The sheet, gaps and all, its fitted values with bounds, the keys that rules would fill, and what was noticed."""

    sheet: KesSheet
    fitted: tuple[FittedValue, ...]
    assumed: frozenset[str]
    findings: tuple[Finding, ...]


def fit_sheet(name: str, values: Mapping[str, Given], loops: Sequence[RecordedLoop], texts: Mapping[str, str] | None = None) -> Fit:
    """values: FAST readings and values of the sheet by key; texts: what the files say of the fabric in words, by key of the sheet (`fibre`), of which a `name`
    is not used. FabricError, with the file and line of what it is about, for readings that no cloth can have, what is no loop, a value had twice, tension to
    different forces, and a sheet that contradicts itself or cannot be completed."""
    texts = dict(texts or {})
    called = texts.pop("name", name)
    files = {key: given.file for key, given in values.items()} | {loop.key: loop.file for loop in loops}
    fitted: list[FittedValue] = []
    try:
        fitted += _fitted(values, loops, files)
        printed = {key: given for key, given in values.items() if not _is_reading(key)}
        sources = {given.file: given.source for given in values.values() if given.source}
        sheet = fitted_sheet(name, fitted, printed, files, sources, texts)
        tension = [loop for loop in loops if loop.test == "tension"]
        findings = [*unread([loop for loop in loops if loop.test != "tension"]), *doubtful_starts(tension)]
        findings += doubtful({key: given.value for key, given in values.items()})
        if called != name:
            findings.append(Finding("info", "name", f"{called!r} in the tables is not used; the sheet is {name!r}, as its file"))
        if sheet.W is None:
            lacking = Finding("warning", "W", "no mass per area came; the sheet needs one before anything can be draped")
            return Fit(sheet, tuple(fitted), frozenset(), (*findings, *noticed(sheet), lacking))
        completed = complete(sheet)
        return Fit(sheet, tuple(fitted), completed.assumed, (*findings, *completed.findings))
    except FabricError as fault:
        if fault.file is not None:
            raise
        if (given := values.get(fault.key or "")) is not None:
            raise FabricError(f"line {given.line}: {fault.message}", file=given.file, key=fault.key) from None
        behind = [key for value in fitted if value.key == fault.key for key in value.of] or list(files)
        raise FabricError(fault.message, file=_listed(behind, files), key=fault.key) from None


def _is_reading(key: str) -> bool:
    return key.partition(".")[0] in FAST_QUANTITIES


def _listed(keys: Sequence[str], files: Mapping[str, str]) -> str:
    return ", ".join(dict.fromkeys(files[key] for key in keys))


def _fitted(values: Mapping[str, Given], loops: Sequence[RecordedLoop], files: Mapping[str, str]) -> list[FittedValue]:
    """All that can be fitted, with one Fm."""
    for i, loop in enumerate(loops):
        for other in loops[:i]:
            if other.key == loop.key:
                raise loop.refuse(f"a second {loop.test} loop of {loop.way}, after that in {other.file}, {other.place}; one is allowed")
    of_fast = fit_fast({key: given.value for key, given in values.items()})
    of_loops = fit_tension([loop for loop in loops if loop.test == "tension"])
    ends = [value for value in (*of_loops, *of_fast) if value.key == "Fm"]
    if len({end.value for end in ends}) > 1:
        came = " and ".join(f"{what} to {end.value:g} ({_listed(end.of, files)})" for what, end in zip(("tension loops", "FAST extensions"), ends))
        raise FabricError(f"{came} gf/cm do not go together; one Fm belongs to a sheet, leave either out", key="Fm", file=_listed(ends[1].of, files))
    printed = [key for key in values if key.partition(".")[0] in ("LT", "WT", "EMT")]
    usual = values["Fm"].value if "Fm" in values else USUAL_FM
    if printed and ends and ends[0].value != usual:
        came = f"{', '.join(printed)} as a tester prints them, at {usual:g} gf/cm, beside tests to {ends[0].value:g} ({_listed(ends[0].of, files)})"
        raise FabricError(f"{came}; one Fm belongs to a sheet, leave either out", key=printed[0])
    return [
        *(value for value in of_fast if value.key != "Fm" or len(ends) == 1),
        *of_loops,
        *fit_friction([loop for loop in loops if loop.test != "tension"]),
    ]
