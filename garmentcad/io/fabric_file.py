"""Fabric files: one KES sheet a YAML file (docs/fabric.md has the format), or a laboratory's CSV file of one fabric."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any

from garmentcad.errors import FabricError, FileError, InputError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.missing import Completed, complete
from garmentcad.fabric.sheet import CalibratedLaw, KesSheet, sheet_data, sheet_from
from garmentcad.io.arguments import refuse_unnamed
from garmentcad.io.atomic import write_atomic
from garmentcad.io.kes_csv import read_kes_csv
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.yaml_file import parse_yaml, read_yaml, refuse_no_yaml
from garmentcad.pattern.parse import shown

_SAID = 3  # of what was noticed in reading, where a sheet is refused for what may have been lost there
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*|2HG5?|2HB")
_LAW = re.compile(r"""law\s*:|"law"\s*:|'law'\s*:""")  # the line at which a law begins
_UNSEEN = re.compile("[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]")  # what YAML takes for line ends or refuses is written by its number


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
    FabricError for what is not a KES sheet. What a CSV file has and the sheet has not is a UserWarning."""
    path = fabric_path(name_or_file)
    sheet, seen = _sheet(path)
    for finding in seen:
        warnings.warn(f"{path}: {finding}", stacklevel=2)
    return sheet


def load_fabric(fabric: str | Path | KesSheet) -> Completed:
    """The same sheet, or one that was made, checked against itself and completed by the rules, with all findings."""
    if isinstance(fabric, KesSheet):
        return complete(fabric)
    path = fabric_path(fabric)
    sheet, seen = _sheet(path)
    try:
        done = complete(sheet)
    except FabricError as fault:
        raise FabricError("; ".join([fault.message, *(f"{one.key}: {one.message}" for one in seen[:_SAID])]), file=str(path), key=fault.key) from None
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
    KesSheet, no file, or a file that ends in neither .yaml nor .yml."""
    if not isinstance(sheet, KesSheet):
        raise InputError(f"a KesSheet is wanted, came {shown(sheet)}", key="sheet")
    refuse_unnamed(path, "path")
    refuse_no_yaml(path)
    return write_atomic(path, "\n".join(_lines(sheet_data(sheet), "")) + "\n")


def write_law(path: str | Path, law: CalibratedLaw) -> Path:
    """Put `law` into a YAML fabric file in place of one that stands there; every other line stays as it was typed. FileError where it cannot be written, or
    where the file is laid out so that lines cannot be put into it; FabricError for a file that is no YAML fabric."""
    path = Path(path)
    wanted = sheet_from(read_yaml(path), str(path)).model_copy(update={"law": law})
    typed = path.read_bytes().decode("utf-8")
    end = "\r\n" if "\r\n" in typed else "\n"
    kept, inside = [], False
    for line in typed.split(end):
        if line.strip() and not line.startswith((" ", "\t", "#", "}")):
            inside = _LAW.match(line) is not None
        if not inside or line.lstrip().startswith("#"):
            kept.append(line)
    while kept and not kept[-1]:
        kept.pop()
    text = end.join([*kept, *_lines({"law": law.model_dump()}, ""), ""])
    try:
        read = sheet_from(parse_yaml(text.removeprefix("\ufeff"), str(path)), str(path))
    except (FileError, FabricError):
        read = None
    if read != wanted:
        raise FileError("has no room for a law: write its keys at the start of their lines, one below the other, and nothing behind them", file=str(path))
    return write_atomic(path, text)


def _lines(data: dict[str, Any], indent: str) -> list[str]:
    """YAML by hand, so that a value and its source stay on one line as people write them. JSON scalars are YAML scalars."""
    lines: list[str] = []
    for key, entry in data.items():
        if isinstance(entry, dict) and isinstance(entry.get("value", ""), str):
            lines += [f"{indent}{_key(key)}:", *_lines(entry, indent + "  ")]
        elif isinstance(entry, dict):
            lines.append(f"{indent}{_key(key)}: {{{', '.join(f'{_key(name)}: {_scalar(value)}' for name, value in entry.items())}}}")
        else:
            lines.append(f"{indent}{_key(key)}: {_scalar(entry)}")
    return lines


def _key(key: str) -> str:
    return key if _PLAIN.fullmatch(key) and key.lower() not in ("true", "false", "null") else _scalar(key)


def _scalar(value: Any) -> str:
    return _UNSEEN.sub(lambda found: f"\\u{ord(found[0]):04x}", json.dumps(value, ensure_ascii=False))
