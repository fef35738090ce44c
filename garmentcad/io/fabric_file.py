"""Fabric files: one KES sheet a YAML file (docs/fabric.md has the format), or a laboratory's CSV file of one fabric."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from garmentcad.errors import FabricError, InputError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.missing import Completed, complete
from garmentcad.fabric.sheet import CalibratedLaw, KesSheet, sheet_data, sheet_from
from garmentcad.io.arguments import refuse_unnamed
from garmentcad.io.atomic import write_atomic
from garmentcad.io.kes_csv import read_kes_csv
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.yaml_file import read_yaml
from garmentcad.pattern.parse import shown

_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*|2HG5?|2HB")


def fabric_path(name_or_file: str | Path) -> Path:
    """File of a fabric: a shipped name (`wool-suiting`) or a path that ends in .yaml, .yml or .csv. FileError for an unknown name, InputError for no name
    or path at all."""
    refuse_unnamed(name_or_file, "fabric")
    if isinstance(name_or_file, Path) or name_or_file.lower().endswith((".yaml", ".yml", ".csv")):
        return Path(name_or_file)
    return shipped_file("fabrics", name_or_file)


def fabric_names() -> list[str]:
    """Names of the shipped fabrics."""
    return shipped_names("fabrics")


def read_fabric(name_or_file: str | Path) -> KesSheet:
    """The sheet of a shipped fabric or in a fabric file (YAML, or CSV with one fabric), gaps and all. FileError for an unknown name and what is not plain YAML,
    FabricError for what is not a KES sheet."""
    return _sheet(fabric_path(name_or_file))[0]


def load_fabric(fabric: str | Path | KesSheet) -> Completed:
    """The same sheet, or one that was made, checked against itself and completed by the rules, with all findings."""
    if isinstance(fabric, KesSheet):
        return complete(fabric)
    path = fabric_path(fabric)
    sheet, seen = _sheet(path)
    try:
        done = complete(sheet)
    except FabricError as fault:
        raise FabricError(fault.message, file=str(path), key=fault.key) from None
    return done._replace(findings=(*seen, *done.findings))


def _sheet(path: Path) -> tuple[KesSheet, tuple[Finding, ...]]:
    """The sheet in a file, and what was noticed in reading."""
    if path.suffix.lower() != ".csv":
        return sheet_from(read_yaml(path), str(path)), ()
    sheets, seen = read_kes_csv(path)
    if len(sheets) > 1:
        names = ", ".join(sheet.name for sheet in sheets[:10])
        raise FabricError(f"{len(sheets)} fabrics came ({names}{', ...' if len(sheets) > 10 else ''}); a file of one fabric is wanted", file=str(path))
    return sheets[0], seen


def write_fabric(sheet: KesSheet, path: str | Path) -> Path:
    """Write a sheet as a fabric file that `read_fabric` reads back to an equal sheet. FileError where the folder cannot be written, InputError for what is no
    KesSheet or no file."""
    if not isinstance(sheet, KesSheet):
        raise InputError(f"a KesSheet is wanted, came {shown(sheet)}", key="sheet")
    refuse_unnamed(path, "path")
    return write_atomic(path, "\n".join(_lines(sheet_data(sheet), "")) + "\n")


def write_law(path: str | Path, law: CalibratedLaw) -> Path:
    """Put `law` into a YAML fabric file in place of one that stands there; every other line stays as it was typed. FileError where it cannot be written,
    FabricError for a file that is no YAML fabric."""
    sheet_from(read_yaml(path), str(path))
    kept, inside = [], False
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith((" ", "\t", "#", "}")):
            inside = line.startswith("law:")
        if not inside:
            kept.append(line)
    text = "\n".join([*kept, *_lines({"law": law.model_dump()}, "")]) + "\n"
    return write_atomic(path, text)


def _lines(data: dict[str, Any], indent: str) -> list[str]:
    """YAML by hand, so that a value and its source stay on one line as people write them. JSON scalars are YAML scalars."""
    lines: list[str] = []
    for key, entry in data.items():
        if isinstance(entry, dict) and "value" not in entry:
            lines += [f"{indent}{_key(key)}:", *_lines(entry, indent + "  ")]
        elif isinstance(entry, dict):
            lines.append(f"{indent}{_key(key)}: {{{', '.join(f'{_key(name)}: {_scalar(value)}' for name, value in entry.items())}}}")
        else:
            lines.append(f"{indent}{_key(key)}: {_scalar(entry)}")
    return lines


def _key(key: str) -> str:
    return key if _PLAIN.fullmatch(key) and key.lower() not in ("true", "false", "null") else _scalar(key)


def _scalar(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
