"""CSV files of KES values as laboratories print them: one fabric a row, or one value a row. Comma, semicolon or tab; decimal point or comma.

Nothing is dropped in silence: every column or row that is not understood is a finding. A cell that should be a number, or a unit of its value, and is not is
refused.
A value whose label names no direction is taken as the mean of warp and weft.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.fast import FAST_QUANTITIES
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.quantity import QUANTITIES, Quantity
from garmentcad.fabric.sheet import KesSheet, sheet_from
from garmentcad.io.csv_table import CsvTable, Row, cell_number, read_table, row_cells
from garmentcad.io.kes_header import DIRECTIONS, Label, label_words, read_label, unit_fault

_TEXTS = {"name": "name", "fabric": "name", "fabric name": "name", "sample": "name", "source": "source", "fibre": "fibre", "fiber": "fibre"}
_TEXTS |= {"composition": "fibre", "weave": "weave", "description": "description"}
_PARAMETER = {"parameter", "property", "quantity", "symbol", "characteristic", "characteristic value"}
_WAYS = {word: way for word, way in DIRECTIONS.items() if not word.isdigit()}
_BLANK = {"", "-", "–", "—", "n/a", "na", "nd", "n.d."}  # what laboratories print for a value that was not measured
WANTED = "`name;W;B warp;B weft` (one fabric a row) or `property;warp;weft` (one value a row)"


class KesCsv(NamedTuple):
    """Sheets in the order of the file (gaps left), and what was not understood."""

    sheets: tuple[KesSheet, ...]
    findings: tuple[Finding, ...]


class FabricValues(NamedTuple):
    """What a table says of one fabric: texts, numbers in the testers' units by key with their lines, and the line where it begins."""

    texts: dict[str, str]
    values: dict[str, float]
    lines: dict[str, int]
    line: int


_SAID = 3  # findings in the message of a table without a fabric


def read_kes_csv(path: str | Path, source: str | None = None) -> KesCsv:
    """Sheets of a CSV file. source: who measured them, where the file has no such column; otherwise the file's name and line stand as the source.

    FileError for a file that is no such table, FabricError (with line and column) for a value that is refused.
    """
    table = read_table(path, lambda cells: known_labels(cells, QUANTITIES), WANTED)
    fabrics = fabric_values(table, str(path), QUANTITIES)
    return KesCsv(tuple(_sheet(fabric, Path(path), source, i + 1) for i, fabric in enumerate(fabrics)), tuple(table.findings))


def known_labels(cells: list[str], quantities: Mapping[str, Quantity]) -> int:
    """How many cells of a line are labels of a table of values."""
    return sum(bool(_plain(cell) in _PARAMETER | set(_TEXTS) | set(_WAYS) | {"value", "unit", "units"} or read_label(cell, quantities)) for cell in cells)


def fabric_values(table: CsvTable, file: str, quantities: Mapping[str, Quantity]) -> list[FabricValues]:
    """Values of the fabrics of a table, in its order; what is not understood joins the table's findings. Errors as `read_kes_csv`."""
    reader = _ByValue if any(_plain(cell) in _PARAMETER for cell in table.header[1]) else _ByFabric
    fabrics = reader(file, quantities, table.findings).read(table.header, table.rows)
    if not fabrics:
        why = "".join(f"; {finding.key}: {finding.message}" for finding in table.findings[:_SAID])
        raise FileError(f"no fabric below the header on line {table.header[0]}{why}", file=file)
    return fabrics


def _sheet(fabric: FabricValues, path: Path, source: str | None, number: int) -> KesSheet:
    data: dict[str, object] = {"schema": 1, "name": f"{path.stem}-{number}", "source": source or f"{path.name}, line {fabric.line}"}
    data |= {key: text for key, text in fabric.texts.items() if text}
    for key, value in fabric.values.items():
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
        raise FabricError(f"line {fabric.lines.get(fault.key or '', fabric.line)}: {fault.message}", file=str(path), key=fault.key) from None


def _plain(cell: str) -> str:
    return " ".join(label_words(cell))


class _Reader:
    """What both layouts share."""

    def __init__(self, file: str, quantities: Mapping[str, Quantity], findings: list[Finding]) -> None:
        self.file, self.quantities, self.findings = file, quantities, findings

    def skip(self, line: int, column: str, why: str) -> None:
        self.findings.append(Finding("warning", f"line {line}, {column}", why))

    def label(self, text: str) -> Label | None:
        return read_label(text, self.quantities)

    def unknown(self, text: str) -> str:
        """Why a label is not read."""
        return "a FAST value, of which `garmentcad fabric fit` makes a sheet" if read_label(text, FAST_QUANTITIES) else "not understood"

    def number(self, text: str, label: Label, line: int, column: str) -> float | None:
        """Number in a cell, in the testers' unit; None for a blank."""
        if text.lower() in _BLANK:
            return None
        percent = self.quantities[label.key.partition(".")[0]].unit == "%"
        return cell_number(text, label.factor, percent, self.file, f"line {line}, {column}", label.key)


class _ByFabric(_Reader):
    """One fabric a row; labels in the header."""

    def read(self, header: Row, rows: list[Row]) -> list[FabricValues]:
        header_line, labels = header
        texts: dict[int, str] = {}
        values: dict[int, Label] = {}
        first: dict[str, str] = {}
        for column, cell in enumerate(labels):
            text, label = _TEXTS.get(_plain(cell)), self.label(cell)
            meaning = text or (label.key if label else None)
            if meaning is None:
                filled = sum(column < len(cells) and bool(cells[column].strip()) for _, cells in rows)
                if cell.strip() or filled:
                    why = unit_fault(cell, "", self.quantities) or self.unknown(cell)
                    self.skip(header_line, f"column {cell.strip()[:60]!r}", f"{why}; its {filled} values are not used")
                continue
            if meaning in first:
                where = f"line {header_line}, columns {first[meaning]!r} and {cell.strip()!r}"
                raise FabricError(f"{where}: both mean {meaning}; one column for a value is allowed", file=self.file)
            first[meaning] = cell.strip()
            if text:
                texts[column] = text
            elif label:
                values[column] = label
        fabrics: list[FabricValues] = []
        for line, raw in rows:
            cells = row_cells((line, raw), header, self.file)
            numbers = {label.key: self.number(cells[c], label, line, f"column {labels[c].strip()!r}") for c, label in values.items()}
            known = {key: number for key, number in numbers.items() if number is not None}
            if not known:
                self.skip(line, "the whole row", f"no value in it: {' '.join(raw).strip()[:100]!r}")
                continue
            fabrics.append(FabricValues({text: cells[c] for c, text in texts.items()}, known, dict.fromkeys(known, line), line))
        return fabrics


class _ByValue(_Reader):
    """One value a row; the label in the first known column, numbers under `value` or under `warp`, `weft`, `mean`, `bias`."""

    def read(self, header: Row, rows: list[Row]) -> list[FabricValues]:
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
        lines: dict[str, dict[str, int]] = {}
        first: dict[str, int] = {}
        for line, raw in rows:
            cells = row_cells((line, raw), header, self.file)
            entry = {role: cells[column] for role, column in places.items()}
            fabric = entry.get("name", "")
            first.setdefault(fabric, line)
            known = values.setdefault(fabric, {})
            about = texts.setdefault(fabric, {"name": fabric})
            filled = [role for role in numbered if entry[role].lower() not in _BLANK]
            text = _TEXTS.get(_plain(entry["label"]))
            if text:
                about[text] = entry[filled[0]] if filled else ""
                continue
            for role in filled:
                way = entry.get("way", "") if role == "value" else role
                label = self.label(f"{entry['label']} {way} {entry.get('unit', '')}")
                if label is None and len(filled) == 1:  # a value of the whole fabric under any column
                    label = self.label(f"{entry['label']} {entry.get('unit', '')}")
                    label = None if label is None or "." in label.key else label
                if label is None:
                    unit = entry.get("unit", "")
                    fault = unit_fault(f"{way} {entry['label']}", unit, self.quantities) or unit_fault(entry["label"], unit, self.quantities)
                    if fault and unit:
                        raise FileError(f"line {line}, column {labels[places['unit']].strip()!r}: {fault}", file=self.file)
                    self.skip(line, f"{role} of {entry['label'][:60]!r}", f"{fault or self.unknown(entry['label'])}; {entry[role][:60]!r} is not used")
                    continue
                number = self.number(entry[role], label, line, f"column {role}")
                if label.key in known:
                    raise FabricError(f"line {line}: {label.key} stands twice for the same fabric; once is allowed", file=self.file)
                if number is not None:
                    known[label.key] = number
                    lines.setdefault(fabric, {})[label.key] = line
        for fabric, known in values.items():
            if not known:
                self.skip(first[fabric], f"fabric {fabric[:60]!r}", "no value in its rows; it is left out")
        return [FabricValues(texts[fabric], known, lines[fabric], first[fabric]) for fabric, known in values.items() if known]
