"""The door for CSV files: encoding, separator and header line are found, letterhead above it is reported, and caps hold before anything is parsed."""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.finding import Finding
from garmentcad.io.yaml_file import MAX_BYTES, read_bytes

MAX_ROWS = 5_000
PREAMBLE_ROWS = 30  # lines of letterhead that may stand above the header

_NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?")

Row = tuple[int, list[str]]  # line number and cells


class CsvTable(NamedTuple):
    """The header line, the rows below it that are not blank, and what was noticed so far."""

    header: Row
    rows: list[Row]
    findings: list[Finding]


def read_table(path: str | Path, understood: Callable[[list[str]], int], wanted: str, max_rows: int = MAX_ROWS, max_bytes: int = MAX_BYTES) -> CsvTable:
    """Table of a CSV file with comma, semicolon or tab. understood: how many labels of a line are known; the best line near the top is the header.

    wanted: what a header looks like, for the message. FileError for a file that is no such table.
    """
    file = str(path)
    findings: list[Finding] = []
    text = _text(read_bytes(path, max_bytes), file, findings)
    tables, faults = [], []
    for delimiter in (";", "\t", ","):
        try:
            tables.append(_cut(text, delimiter, file, understood, max_rows))
        except csv.Error as fault:  # quotes that fit another delimiter, or none
            faults.append(str(fault))
    known, header, rows = max(tables, key=lambda table: table[0], default=(0, 0, []))
    if known < 2 and faults:
        raise FileError(f"not valid CSV: {faults[0]}", file=file)
    if known < 2:
        raise FileError(f"no header line found: a line with at least two known labels is wanted, such as {wanted}", file=file)
    findings += [Finding("info", f"line {line}", f"above the header, not used: {' '.join(cells).strip()[:100]!r}") for line, cells in rows[:header]]
    return CsvTable(rows[header], rows[header + 1 :], findings)


def row_cells(row: Row, header: Row, file: str) -> list[str]:
    """Cells of a row, stripped, as many as the header has. FileError for a row with more."""
    (line, cells), (header_line, labels) = row, header
    width = len(labels)
    if any(cell.strip() for cell in cells[width:]):
        hint = "; decimal commas need semicolons between the cells, or quotes" if width else ""
        raise FileError(f"line {line}: {len(cells)} cells, but the header on line {header_line} has {width}{hint}", file=file)
    return [cell.strip() for cell in cells[:width]] + [""] * (width - len(cells))


def cell_number(text: str, factor: float, percent: bool, file: str, place: str, key: str) -> float:
    """Number in a cell times a factor. FabricError (with place and the key it came for) for anything else; what is a blank the callers know."""
    bare = text.removesuffix("%").rstrip() if percent else text
    if not _NUMBER.fullmatch(bare):
        allowed = "a number with a decimal point or comma" + (", with or without %," if percent else "")
        raise FabricError(f"{place}: {text[:60]!r} came for {key}; {allowed} or a blank is allowed", file=file)
    return float(f"{float(bare.replace(',', '.')) * factor:.12g}")  # 123.8 g/m2 is 12.38 mg/cm2, not 12.379999999999999


def _text(raw: bytes, file: str, findings: list[Finding]) -> str:
    """Text of the file: UTF-8 or UTF-16 with their marks, else what spreadsheets on Windows write."""
    try:
        text = raw.decode("utf-16" if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
        findings.append(Finding("info", "", "the file is not UTF-8; it was read as Windows-1252"))
    if "\0" in text:
        raise FileError("the file holds null characters; a CSV file is text", file=file)
    return text


def _cut(text: str, delimiter: str, file: str, understood: Callable[[list[str]], int], max_rows: int) -> tuple[int, int, list[Row]]:
    """The text cut at one delimiter: understood labels in the best line near the top, the place of that line, and the rows that are not blank.

    csv.Error for broken quotes.
    """
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[Row] = []
    for cells in reader:
        if any(cell.strip() for cell in cells):
            rows.append((reader.line_num, cells))
        if len(rows) > max_rows:
            raise FileError(f"more than {max_rows} rows; that is the cap", file=file)
    counts = [understood(cells) for _, cells in rows[:PREAMBLE_ROWS]]
    best = max(counts, default=0)
    return best, counts.index(best) if counts else 0, rows
