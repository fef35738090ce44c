"""The files that `fabric fit` takes: tester curves, or a table of FAST readings, lengths and printed values. The header tells which."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.given import Given
from garmentcad.fabric.recorded_loop import RecordedLoop
from garmentcad.io.csv_table import read_table
from garmentcad.io.kes_csv import fabric_values, known_labels
from garmentcad.io.kes_header import FIT_QUANTITIES
from garmentcad.io.loop_csv import loop_labels, recorded_loops

MAX_BYTES = 20_000_000
MAX_ROWS = 200_000
WANTED = "`strain warp [%];force warp [gf/cm]` (curves) or `property;unit;warp;weft` (values)"


class FitInput(NamedTuple):
    """Values by key (KES and FAST), loops, what was not understood, and what the tables say of the fabric in words, by key of the sheet (`fibre`)."""

    values: dict[str, Given]
    loops: list[RecordedLoop]
    findings: list[Finding]
    texts: dict[str, str]


def read_fit_files(paths: Sequence[str | Path]) -> FitInput:
    """All that the files hold of one fabric. FileError or FabricError for what is no such file, several fabrics, a value in two of them, or words
    that contradict each other."""
    values: dict[str, Given] = {}
    loops: list[RecordedLoop] = []
    findings: list[Finding] = []
    texts: dict[str, str] = {}
    places: dict[str, str] = {}  # of the texts
    for path in paths:
        file = str(path)
        table = read_table(path, lambda cells: max(loop_labels(cells), known_labels(cells, FIT_QUANTITIES)), WANTED, MAX_ROWS, MAX_BYTES)
        if loop_labels(table.header[1]):
            loops += recorded_loops(table, file)
        else:
            fabrics = fabric_values(table, file, FIT_QUANTITIES)
            if len(fabrics) > 1:
                raise FileError(f"{len(fabrics)} fabrics came; a file of one fabric is wanted", file=file)
            (fabric,) = fabrics
            for key, number in fabric.values.items():
                line = fabric.lines[key]
                if key in values:
                    earlier = f"{values[key].file}, line {values[key].line}"
                    raise FabricError(f"line {line}: {key} stands in an earlier file too ({earlier}); once is allowed", file=file, key=key)
                values[key] = Given(number, file, line, fabric.texts.get("source", ""))
            for key, text in fabric.texts.items():
                if key == "source":  # of the values of this table; others may be another laboratory's
                    continue
                line = fabric.lines[key]
                if texts.setdefault(key, text) != text:
                    came = f"{text[:60]!r} came for {key}, but {texts[key][:60]!r} in an earlier file ({places[key]})"
                    raise FabricError(f"line {line}: {came}; one is allowed for a fabric", file=file, key=key)
                places.setdefault(key, f"{file}, line {line}")
        findings += table.findings
    return FitInput(values, loops, findings, texts)
