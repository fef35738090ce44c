"""CSV files of KES values as laboratories print them: one fabric a row, or one value a row. Comma, semicolon or tab; decimal point or comma.

Nothing is dropped in silence: every column or row that is not understood is a finding. A cell that should be a number, or a unit of its value, and is not is
refused.
A value for which neither its label nor its row or column names a direction is taken as the mean of warp and weft.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.quantity import QUANTITIES, Quantity
from garmentcad.fabric.sheet import KesSheet, sheet_from
from garmentcad.io.csv_table import CsvTable, Row, cell_number, read_table, row_cells
from garmentcad.io.kes_header import (
    DIRECTIONS,
    Label,
    LabelParts,
    label_fault,
    label_parts,
    label_words,
    read_label,
    unit_factor,
    value_key,
    wrong_unit,
)

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
    """What a table says of one fabric: texts, numbers in the testers' units by key, the lines of both, and the line where it begins."""

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
    measured = fabric.texts.get("source") or source
    data: dict[str, object] = {"schema": 1, "name": f"{path.stem}-{number}"} | fabric.texts | {"source": measured or f"{path.name}, line {fabric.line}"}
    for key, value in fabric.values.items():
        line = fabric.lines[key]
        given = value if measured or line == fabric.line else {"value": value, "source": f"{path.name}, line {line}"}
        name, _, way = key.partition(".")
        if way:
            entry = data.setdefault(name, {})
            assert isinstance(entry, dict)
            entry[way] = given
        else:
            data[name] = given
    try:
        return sheet_from(data)
    except FabricError as fault:
        line = fabric.lines.get((fault.key or "").removesuffix(".value"), fabric.line)
        raise FabricError(f"line {line}: {fault.message}", file=str(path), key=fault.key) from None


def _plain(cell: str) -> str:
    return " ".join(label_words(cell))


def _blank(cell: str) -> bool:
    return cell.lower() in _BLANK


class _Reader:
    """What both layouts share."""

    def __init__(self, file: str, quantities: Mapping[str, Quantity], findings: list[Finding]) -> None:
        self.file, self.quantities, self.findings = file, quantities, findings

    def skip(self, line: int, column: str, why: str) -> None:
        self.findings.append(Finding("warning", f"line {line}, {column}", why))

    def skip_column(self, header: Row, column: int, rows: list[Row], why: str) -> None:
        """A column that is not understood; one without a label and a value is none."""
        header_line, labels = header
        filled = sum(column < len(cells) and bool(cells[column].strip()) for _, cells in rows)
        if labels[column].strip() or filled:
            self.skip(header_line, f"column {labels[column].strip()[:60]!r}", f"{why}; its {filled} values are not used")

    def number(self, text: str, label: Label, line: int, column: str) -> float:
        """Number in a cell, in the testers' unit."""
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
            text, label = _TEXTS.get(_plain(cell)), read_label(cell, self.quantities)
            meaning = text or (label.key if label else None)
            if meaning is None:
                self.skip_column(header, column, rows, label_fault(cell, self.quantities))
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
            filled = {c: label for c, label in values.items() if not _blank(cells[c])}
            known = {label.key: self.number(cells[c], label, line, f"column {labels[c].strip()!r}") for c, label in filled.items()}
            if not known:
                self.skip(line, "the whole row", f"no value in it: {' '.join(raw).strip()[:100]!r}")
                continue
            about = {text: cells[c] for c, text in texts.items() if cells[c]}
            fabrics.append(FabricValues(about, known, dict.fromkeys([*about, *known], line), line))
        return fabrics


class _Entry(NamedTuple):
    """A row of a table of one value a row: its line, its cells by role, and the headers of their columns by role."""

    line: int
    cells: dict[str, str]
    titles: dict[str, str]

    def filled(self, roles: Iterable[str]) -> list[str]:
        return [role for role in roles if not _blank(self.cells.get(role, ""))]

    def place(self, role: str) -> str:
        return f"line {self.line}, column {self.titles[role]!r}"


class _ByValue(_Reader):
    """One value a row; the label in the first known column, numbers under `value` or under `warp`, `weft`, `mean`, `bias`, their direction also in the label or
    under `direction`."""

    def read(self, header: Row, rows: list[Row]) -> list[FabricValues]:
        header_line, labels = header
        places: dict[str, int] = {}
        for column, cell in enumerate(labels):
            plain = _plain(cell)
            role = "label" if plain in _PARAMETER else "unit" if plain in ("unit", "units") else "value" if plain == "value" else _WAYS.get(plain)
            role = role or ("name" if _TEXTS.get(plain) == "name" else None) or ("way" if plain == "direction" else None)
            if role is None:
                self.skip_column(header, column, rows, "not understood")
            elif role in places:
                raise FabricError(f"line {header_line}: two columns {cell.strip()!r}; one is allowed", file=self.file)
            else:
                places[role] = column
        numbered = [role for role in ("value", "warp", "weft", "mean", "bias") if role in places]
        if not numbered:
            raise FileError(f"line {header_line}: no column of numbers; a column value, warp, weft, mean or bias is wanted", file=self.file)
        titles = {role: labels[column].strip() for role, column in places.items()}
        fabrics: dict[str, FabricValues] = {}
        seen: set[tuple[str, str, str]] = set()
        for line, raw in rows:
            cells = row_cells((line, raw), header, self.file)
            entry = _Entry(line, {role: cells[column] for role, column in places.items()}, titles)
            name = entry.cells.get("name", "")
            about = {"name": name} if name else {}
            fabric = fabrics.setdefault(name, FabricValues(about, {}, dict.fromkeys(about, line), line))
            filled = entry.filled(numbered)
            text = _TEXTS.get(_plain(entry.cells["label"]))
            if text:
                # a text has neither unit nor direction: what stands there alone is the text, typed a column too far left
                self.add_text(text, [entry.cells[role] for role in filled or entry.filled(("way", "unit"))], fabric, line)
                continue
            unit = entry.cells.get("unit", "")
            if not filled and re.fullmatch(r"[-+]?[\d.,]+", unit):
                self.skip(line, f"unit of {entry.cells['label'][:60]!r}", f"the number {unit[:60]} stands where its unit belongs; it is not used")
            for role in filled:
                parts = label_parts(entry.cells["label"], self.quantities)
                way = self.way(parts, role, entry) if parts else ""
                label = self.meaning(parts, way, entry)
                if isinstance(label, str):
                    self.skip(line, f"{role} of {entry.cells['label'][:60]!r}", f"{label}; {entry.cells[role][:60]!r} is not used")
                    continue
                key, number = label.key, self.number(entry.cells[role], label, line, f"column {role}")
                where = (name, key, "" if "." in key else way)
                if where in seen:
                    raise FabricError(f"line {line}: {key} stands twice for the same fabric; once is allowed", file=self.file)
                seen.add(where)
                if fabric.values.setdefault(key, number) != number:  # equal ones are one: the thickness of a fabric is often printed under warp and weft
                    came = f"{number:g} came for {key} after {fabric.values[key]:g} on line {fabric.lines[key]}"
                    raise FabricError(f"{entry.place(role)}: {came}; it is one number without directions", file=self.file)
                fabric.lines.setdefault(key, line)
        for name, fabric in fabrics.items():
            if not fabric.values:
                self.skip(fabric.line, f"fabric {name[:60]!r}", "no value in its rows; it is left out")
        return [fabric for fabric in fabrics.values() if fabric.values]

    def add_text(self, key: str, said: list[str], fabric: FabricValues, line: int) -> None:
        for text in said:
            if fabric.texts.setdefault(key, text) != text:
                came = f"{text[:60]!r} came for {key} after {fabric.texts[key][:60]!r} on line {fabric.lines[key]}"
                raise FabricError(f"line {line}: {came}; one is allowed for a fabric", file=self.file)
            fabric.lines.setdefault(key, line)

    def way(self, parts: LabelParts, role: str, entry: _Entry) -> str:
        """Direction of a number: of its label, of its row and of its column, which must not contradict each other; "" for none.

        A column `mean` is the mean of specimens where the row has a direction.
        """
        direction = entry.cells.get("way", "")
        of_row = "" if _blank(direction) else DIRECTIONS.get(_plain(direction), direction[:60])
        way = parts.way
        for at, other in (("way", of_row), (role, "" if role == "value" else role)):
            if way and other and other != way and at != "mean":
                came = f"{other} came for {entry.cells['label'][:60]!r}, which is of {way} in this row"
                raise FabricError(f"{entry.place(at)}: {came}; one direction is allowed", file=self.file)
            way = way or other
        return way

    def meaning(self, parts: LabelParts | None, way: str, entry: _Entry) -> Label | str:
        """Meaning of a number of a row, or why its label or direction is not understood."""
        text, unit = entry.cells["label"], entry.cells.get("unit", "")
        factor = unit_factor(parts.rest, parts.quantity) if parts else None
        if parts is None or factor is None:
            return label_fault(text, self.quantities, way)
        quantity = parts.quantity
        if way and quantity.directions and way not in quantity.directions:
            return f"the direction {way!r} for {quantity.name}; allowed are {', '.join(quantity.directions)}"
        if label_words(unit):
            of_column = unit_factor(unit, quantity)
            if of_column is None:
                raise FileError(f"{entry.place('unit')}: {wrong_unit(unit, way, quantity)}", file=self.file)
            if parts.rest and of_column != factor:
                came = f"{unit[:30]!r} came for {text[:60]!r}, whose label has another unit"
                raise FileError(f"{entry.place('unit')}: {came}; one unit is allowed", file=self.file)
            factor = of_column
        return Label(value_key(quantity, way), factor)
