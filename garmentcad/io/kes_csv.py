"""CSV files of KES values as laboratories print them: one fabric a row, or one value a row. Comma, semicolon or tab; decimal point or comma.

Nothing is dropped in silence: every column or row that is not understood is a finding, and a cell that should be a number and is not is refused.
A value whose label names no direction is taken as the mean of warp and weft.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from pathlib import Path
from typing import NamedTuple

from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.quantity import quantity_of
from garmentcad.fabric.sheet import KesSheet, sheet_from
from garmentcad.io.kes_header import Label, label_words, read_label
from garmentcad.io.yaml_file import read_bytes

MAX_ROWS = 5_000
PREAMBLE_ROWS = 30  # lines of letterhead that may stand above the header

_TEXTS = {"name": "name", "fabric": "name", "fabric name": "name", "sample": "name", "source": "source", "fibre": "fibre", "fiber": "fibre"}
_TEXTS |= {"composition": "fibre", "weave": "weave", "description": "description"}
_PARAMETER = {"parameter", "property", "quantity", "symbol", "characteristic", "characteristic value"}
_WAYS = {"warp": "warp", "weft": "weft", "mean": "mean", "average": "mean", "bias": "bias"}
_BLANK = {"", "-", "–", "—", "n/a", "na", "nd", "n.d."}
_NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?")

Row = tuple[int, list[str]]  # line number and cells


class KesCsv(NamedTuple):
    """Sheets in the order of the file (gaps left), and what was not understood."""

    sheets: tuple[KesSheet, ...]
    findings: tuple[Finding, ...]


def read_kes_csv(path: str | Path, source: str | None = None) -> KesCsv:
    """Sheets of a CSV file. source: who measured them, where the file has no such column; otherwise the file's name and line stand as the source.

    FileError for a file that is no such table, FabricError (with line and column) for a value that is refused.
    """
    file = str(path)
    findings: list[Finding] = []
    text = _text(read_bytes(path), file, findings)
    tables, faults = [], []
    for delimiter in (";", "\t", ","):
        try:
            tables.append(_table(text, delimiter, file))
        except csv.Error as fault:  # quotes that fit another delimiter, or none
            faults.append(str(fault))
    understood, header, rows = max(tables, key=lambda table: table[0], default=(0, 0, []))
    if understood < 2 and faults:
        raise FileError(f"not valid CSV: {faults[0]}", file=file)
    if understood < 2:
        raise FileError(
            "no header line found: a line with at least two known labels is wanted, such as `name;W;B warp;B weft` (one fabric a row)"
            " or `property;warp;weft` (one value a row)",
            file=file,
        )
    findings += [Finding("info", f"line {line}", f"above the header, not used: {' '.join(cells).strip()[:100]!r}") for line, cells in rows[:header]]
    labels = rows[header][1]
    reader = _ByValue if any(_plain(cell) in _PARAMETER for cell in labels) else _ByFabric
    sheets = reader(file, source, findings).read(rows[header], rows[header + 1 :])
    if not sheets:
        raise FileError(f"no fabric below the header on line {rows[header][0]}", file=file)
    return KesCsv(tuple(sheets), tuple(findings))


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


def _table(text: str, delimiter: str, file: str) -> tuple[int, int, list[Row]]:
    """The text cut at one delimiter: understood labels in the best line near the top, the place of that line, and the rows that are not blank.

    csv.Error for broken quotes.
    """
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[Row] = []
    for cells in reader:
        if any(cell.strip() for cell in cells):
            rows.append((reader.line_num, cells))
        if len(rows) > MAX_ROWS:
            raise FileError(f"more than {MAX_ROWS} rows; that is the cap", file=file)
    counts = [_understood(cells) for _, cells in rows[:PREAMBLE_ROWS]]
    best = max(counts, default=0)
    return best, counts.index(best) if counts else 0, rows


def _plain(cell: str) -> str:
    return " ".join(label_words(cell))


def _understood(cells: list[str]) -> int:
    return sum(bool(_plain(cell) in _PARAMETER | set(_TEXTS) | set(_WAYS) | {"value", "unit", "units"} or read_label(cell)) for cell in cells)


class _Reader:
    """What both layouts share: numbers, and sheets from collected values."""

    def __init__(self, file: str, source: str | None, findings: list[Finding]) -> None:
        self.file, self.source, self.findings = file, source, findings

    def skip(self, line: int, column: str, why: str) -> None:
        self.findings.append(Finding("warning", f"line {line}, {column}", why))

    def cells(self, line: int, cells: list[str], width: int, header_line: int) -> list[str]:
        if any(cell.strip() for cell in cells[width:]):
            hint = "; decimal commas need semicolons between the cells, or quotes" if width else ""
            raise FileError(f"line {line}: {len(cells)} cells, but the header on line {header_line} has {width}{hint}", file=self.file)
        return [cell.strip() for cell in cells[:width]] + [""] * (width - len(cells))

    def number(self, text: str, label: Label, line: int, column: str) -> float | None:
        """Number in a cell, in the testers' unit; None for a blank."""
        if text.lower() in _BLANK:
            return None
        quantity = quantity_of(label.key)
        bare = text.removesuffix("%").rstrip() if quantity.unit == "%" else text
        if not _NUMBER.fullmatch(bare):
            allowed = "a number with a decimal point or comma" + (", with or without %," if quantity.unit == "%" else "")
            raise FabricError(f"line {line}, {column}: {text[:60]!r} came for {label.key}; {allowed} or a blank is allowed", file=self.file)
        return float(f"{float(bare.replace(',', '.')) * label.factor:.12g}")  # 123.8 g/m2 is 12.38 mg/cm2, not 12.379999999999999

    def sheet(self, texts: dict[str, str], values: dict[str, float], line: int, number: int) -> KesSheet:
        data: dict[str, object] = {"schema": 1, "name": f"{Path(self.file).stem}-{number}", "source": self.source or f"{Path(self.file).name}, line {line}"}
        data |= {key: text for key, text in texts.items() if text}
        for key, value in values.items():
            name, _, way = key.partition(".")
            if way:
                entry = data.setdefault(name, {})
                assert isinstance(entry, dict)
                entry[way] = value
            else:
                data[name] = value
        try:
            return sheet_from(data)
        except FabricError as fault:
            raise FabricError(f"line {line}: {fault.message}", file=self.file, key=fault.key) from None


class _ByFabric(_Reader):
    """One fabric a row; labels in the header."""

    def read(self, header: Row, rows: list[Row]) -> list[KesSheet]:
        header_line, labels = header
        texts: dict[int, str] = {}
        values: dict[int, Label] = {}
        first: dict[str, str] = {}
        for column, cell in enumerate(labels):
            text, label = _TEXTS.get(_plain(cell)), read_label(cell)
            meaning = text or (label.key if label else None)
            if meaning is None:
                filled = sum(column < len(cells) and bool(cells[column].strip()) for _, cells in rows)
                if cell.strip() or filled:
                    self.skip(header_line, f"column {cell.strip()[:60]!r}", f"not understood; its {filled} values are not used")
                continue
            if meaning in first:
                where = f"line {header_line}, columns {first[meaning]!r} and {cell.strip()!r}"
                raise FabricError(f"{where}: both mean {meaning}; one column for a value is allowed", file=self.file)
            first[meaning] = cell.strip()
            if text:
                texts[column] = text
            elif label:
                values[column] = label
        sheets: list[KesSheet] = []
        for line, raw in rows:
            cells = self.cells(line, raw, len(labels), header_line)
            numbers = {label.key: self.number(cells[c], label, line, f"column {labels[c].strip()!r}") for c, label in values.items()}
            known = {key: number for key, number in numbers.items() if number is not None}
            if not known:
                self.skip(line, "the whole row", f"no value in it: {' '.join(raw).strip()[:100]!r}")
                continue
            sheets.append(self.sheet({text: cells[c] for c, text in texts.items()}, known, line, len(sheets) + 1))
        return sheets


class _ByValue(_Reader):
    """One value a row; the label in the first known column, numbers under `value` or under `warp`, `weft`, `mean`, `bias`."""

    def read(self, header: Row, rows: list[Row]) -> list[KesSheet]:
        header_line, labels = header
        places: dict[str, int] = {}
        for column, cell in enumerate(labels):
            plain = _plain(cell)
            role = "label" if plain in _PARAMETER else "unit" if plain in ("unit", "units") else "value" if plain == "value" else _WAYS.get(plain)
            role = role or ("name" if _TEXTS.get(plain) == "name" else None) or ("way" if plain == "direction" else None)
            if role is None:
                if cell.strip():
                    self.skip(header_line, f"column {cell.strip()[:60]!r}", "not understood; its values are not used")
            elif role in places:
                raise FabricError(f"line {header_line}: two columns {cell.strip()!r}; one is allowed", file=self.file)
            else:
                places[role] = column
        numbered = [role for role in ("value", "warp", "weft", "mean", "bias") if role in places]
        if not numbered:
            raise FileError(f"line {header_line}: no column of numbers; a column value, warp, weft, mean or bias is wanted", file=self.file)
        texts: dict[str, dict[str, str]] = {}
        values: dict[str, dict[str, float]] = {}
        lines: dict[str, int] = {}
        for line, raw in rows:
            cells = self.cells(line, raw, len(labels), header_line)
            entry = {role: cells[column] for role, column in places.items()}
            fabric = entry.get("name", "")
            lines.setdefault(fabric, line)
            known = values.setdefault(fabric, {})
            about = texts.setdefault(fabric, {"name": fabric})
            filled = [role for role in numbered if entry[role].lower() not in _BLANK]
            text = _TEXTS.get(_plain(entry["label"]))
            if text:
                about[text] = entry[filled[0]] if filled else ""
                continue
            for role in filled:
                way = entry.get("way", "") if role == "value" else role
                label = read_label(f"{entry['label']} {way} {entry.get('unit', '')}")
                if label is None and len(filled) == 1:  # a value of the whole fabric under any column
                    label = read_label(f"{entry['label']} {entry.get('unit', '')}")
                    label = None if label is None or "." in label.key else label
                if label is None:
                    self.skip(line, f"{role} of {entry['label'][:60]!r}", f"not understood; {entry[role][:60]!r} is not used")
                    continue
                number = self.number(entry[role], label, line, f"column {role}")
                if label.key in known:
                    raise FabricError(f"line {line}: {label.key} stands twice for the same fabric; once is allowed", file=self.file)
                if number is not None:
                    known[label.key] = number
        return [self.sheet(texts[fabric], known, lines[fabric], i + 1) for i, (fabric, known) in enumerate(values.items()) if known]
