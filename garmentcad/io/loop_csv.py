"""CSV files of raw tester curves: columns in pairs, samples in the order of time, the unit of each column in brackets.

    strain warp [%];force warp [gf/cm]      angle weft [deg];force weft [gf/cm]      curvature bias [1/cm];moment bias [gf.cm/cm]

The first kind of column tells the test. A column of forces belongs to the strain or angle on its left; several pairs, also of different tests, may stand side
by side, the shorter ones ending in blanks. Without a direction a loop counts as the mean of warp and weft.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from garmentcad.errors import FileError, did_you_mean
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.quantity import BENDING_WAYS, WAYS
from garmentcad.fabric.recorded_loop import RecordedLoop, Test, record
from garmentcad.io.csv_table import CsvTable, cell_number, row_cells
from garmentcad.io.kes_header import DIRECTIONS, label_words

_ACROSS: dict[str, Test] = {"strain": "tension", "elongation": "tension", "extension": "tension", "angle": "shear", "curvature": "bending"}
_ALONG: dict[str, tuple[Test, ...]] = {"force": ("tension", "shear"), "load": ("tension", "shear"), "moment": ("bending",)}
_PLAIN = {"shear", "tensile", "tension", "bending", "test", "loop"}  # words that may stand beside the others
_LABEL = re.compile(r"(?P<words>[^\[\]()]*)[\[(](?P<unit>[^\[\]()]*(\([^()]*\))?)[\])](?P<more>[^\[\]()]*)")

# unit as letters -> factor to % | degrees | 1/cm and gf/cm | gf.cm/cm
_UNITS: dict[tuple[Test, bool], dict[str, float]] = {
    ("tension", True): {"%": 1.0, "percent": 1.0, "mm/mm": 100.0, "-": 100.0},
    ("shear", True): {"deg": 1.0, "degree": 1.0, "degrees": 1.0, "°": 1.0, "rad": 180.0 / np.pi},
    ("bending", True): {"1/cm": 1.0, "cm-1": 1.0, "1/m": 0.01, "1/mm": 10.0},
    ("tension", False): {"gf/cm": 1.0, "N/m": 1.0 / 0.980665, "cN/cm": 1.0 / 0.980665, "mN/cm": 0.1 / 0.980665, "N/cm": 100.0 / 0.980665},
    ("bending", False): {"gf.cm/cm": 1.0, "cN.cm/cm": 1.0 / 0.980665, "N.m/m": 1.0 / 9.80665e-3, "N": 1.0 / 9.80665e-3, "mN": 1e-3 / 9.80665e-3},
}
_UNITS["shear", False] = _UNITS["tension", False]
_SIGNS = str.maketrans({"·": ".", "⋅": ".", "*": ".", "⁻": "-", "¹": "1", " ": None})


class _Column(NamedTuple):
    test: Test
    across: bool  # strain, angle, curvature
    way: str
    factor: float


class _Words(NamedTuple):
    kind: str
    way: str
    unit: str | None


def loop_labels(cells: list[str]) -> int:
    """How many cells of a line are labels of tester curves."""
    return sum(_words(cell) is not None for cell in cells)


def recorded_loops(table: CsvTable, file: str) -> list[RecordedLoop]:
    """The loops of a table; a column that is not understood joins its findings. FileError for one without unit or partner, and for a blank between samples."""
    header_line, labels = table.header
    rows = [row_cells(row, table.header, file) for row in table.rows]
    loops: list[RecordedLoop] = []
    across: tuple[int, _Column] | None = None
    lone = ""
    for place, label in enumerate(labels):
        if not label.strip() and not any(cells[place] for cells in rows):
            continue
        where = f"line {header_line}, column {label.strip()[:60]!r}"
        words = _words(label)
        if words is None:
            filled = sum(bool(cells[place]) for cells in rows)
            table.findings.append(Finding("warning", where, f"not understood; its {filled} values are not used"))
            continue
        column = _column(words, across[1] if across else None, file, where)
        if column.across:
            if lone:
                raise FileError(f"{lone}: no column of forces or moments on its right; one is wanted", file=file)
            across, lone = (place, column), where
            continue
        if across is None or across[1].test != column.test:
            raise FileError(f"{where}: no column of {_partner(column.test)} on its left; one is wanted", file=file)
        if column.way and across[1].way and column.way != across[1].way:
            raise FileError(f"{where}: {column.way} beside {across[1].way} on its left; one direction is allowed for a loop", file=file)
        x, y = _samples(rows, table, (across[0], place), (across[1], column), file)
        way = column.way or across[1].way or "mean"
        allowed = BENDING_WAYS if column.test == "bending" else WAYS
        if way not in allowed:
            raise FileError(f"{where}: a {column.test} loop has no direction {way!r}{did_you_mean(way, allowed)}", file=file)
        loops.append(record(column.test, way, x, y, file, f"column {label.strip()[:60]!r}"))
        lone = ""
    if lone:
        raise FileError(f"{lone}: no column of forces or moments on its right; one is wanted", file=file)
    return loops


def _partner(test: Test) -> str:
    return next(word for word, of in _ACROSS.items() if of == test)


def _words(label: str) -> _Words | None:
    """Kind, direction and unit of a label; None where a word of it is not understood."""
    match = _LABEL.fullmatch(label.strip())
    kind = way = ""
    for word in label_words(f"{match['words']} {match['more']}" if match else label):
        if word in _ACROSS or word in _ALONG:
            if kind:
                return None
            kind = word
        elif word in DIRECTIONS and not way:
            way = DIRECTIONS[word]
        elif word not in _PLAIN:
            return None
    return _Words(kind, way, match["unit"].strip() if match else None) if kind else None


def _column(words: _Words, across: _Column | None, file: str, where: str) -> _Column:
    if words.kind in _ACROSS:
        test = _ACROSS[words.kind]
    else:
        tests = _ALONG[words.kind]
        test = across.test if across and across.test in tests else tests[0]
    units = _UNITS[test, words.kind in _ACROSS]
    unit = None if words.unit is None else words.unit.translate(_SIGNS)
    if unit is None or unit not in units:
        came = "no unit in brackets" if words.unit is None else f"the unit {words.unit[:30]!r}"
        raise FileError(f"{where}: {came}; allowed are {', '.join(units)}", file=file)
    return _Column(test, words.kind in _ACROSS, words.way, units[unit])


def _samples(rows: list[list[str]], table: CsvTable, places: tuple[int, int], columns: tuple[_Column, _Column], file: str) -> tuple[np.ndarray, np.ndarray]:
    """The two columns of a loop, up to the first row where both are empty. A word in a cell (`n/a`, `-`) is refused: it may stand for a sample that is lost."""
    found: list[tuple[float, float]] = []
    ended = False
    for (line, _), cells in zip(table.rows, rows):
        x, y = (
            cell_number(cells[place], column.factor, False, file, f"line {line}, column {table.header[1][place].strip()[:60]!r}", f"the {column.test} loop")
            if cells[place]
            else None
            for place, column in zip(places, columns)
        )
        if x is None and y is None:
            ended = True
        elif x is None or y is None or ended:
            raise FileError(f"line {line}: a blank inside the {columns[1].test} loop; both columns are wanted for each sample", file=file)
        else:
            found.append((x, y))
    points = np.array(found, dtype=np.float64).reshape(-1, 2)
    return np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1])
