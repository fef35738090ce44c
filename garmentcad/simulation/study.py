"""The study runner: many cases, one row each, written at once; a study that was stopped goes on where it ended.

A row is keyed by the spec's hash, fabric, mannequin, program version and further parameters. Rows live in `FOLDER/NAME.jsonl`, one JSON object a line, and are
committed with the program: what a table in the docs says can be traced to the run that said it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from garmentcad.errors import FileError, GarmentError
from garmentcad.io.atomic import write_atomic

Row = dict[str, Any]


@dataclass(frozen=True)
class StudyCase:
    """One case. name: short, for the terminal and `--only`; spec_sha256: hash of the spec as the run reads it; parameters: what else changes the run."""

    name: str
    spec_sha256: str
    fabric: str
    mannequin: str
    version: str
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def key(self) -> Row:
        """What tells this case from others; it opens its row."""
        return {
            "case": self.name,
            "spec_sha256": self.spec_sha256,
            "fabric": self.fabric,
            "mannequin": self.mannequin,
            "version": self.version,
            **{name: self.parameters[name] for name in sorted(self.parameters)},
        }


@dataclass(frozen=True)
class StudyRun:
    """rows: of all cases that have one, in the order of the cases; ran: names of the cases run now; failed: name -> message of the refusal."""

    rows: tuple[Row, ...]
    ran: tuple[str, ...]
    failed: dict[str, str]


def run_study(
    name: str,
    cases: Iterable[StudyCase],
    run_case: Callable[[StudyCase], Mapping[str, Any]],
    folder: str | Path,
    *,
    only: str | None = None,
    say: Callable[[str], None] = lambda message: None,
) -> StudyRun:
    """Run every case that has no row yet and append its row to `folder/name.jsonl` as soon as it is there (flushed to disk).

    run_case returns the figures of one case (plain JSON values); it must not reuse a name of the key. only: run cases whose name contains this text.
    A case that raises a GarmentError gets no row and is tried again the next time; any other exception ends the study (rows so far are kept).
    """
    path = Path(folder) / f"{name}.jsonl"
    rows = {_key_text(row, row["key"]): row for row in read_rows(path)}
    ran: list[str] = []
    failed: dict[str, str] = {}
    found: list[Row] = []
    for case in cases:
        key = case.key()
        text = _key_text(key, list(key))
        if text not in rows and (only is None or only in case.name):
            say(f"{name}: {case.name}")
            try:
                figures = dict(run_case(case))
            except GarmentError as error:
                failed[case.name] = str(error)
                say(f"{name}: {case.name}: {error}")
                continue
            clash = sorted((set(figures) & set(key)) | ({"key"} & set(figures)))
            if clash:
                raise ValueError(f"figures of {case.name} reuse names of the key: {', '.join(clash)}")
            rows[text] = {**key, **figures, "key": list(key)}
            _append(path, rows[text])
            ran.append(case.name)
        if text in rows:
            found.append(rows[text])
    return StudyRun(tuple(found), tuple(ran), failed)


def read_rows(path: str | Path) -> list[Row]:
    """All rows of a study file, none if there is no file. Raises FileError naming the line that is not a row; a last line without an end (a run killed
    while writing) is cut off the file, its case runs again."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return []
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"cannot be read ({error})", file=str(path)) from error
    whole, _, torn = text.rpartition("\n")
    if torn:
        write_atomic(path, f"{whole}\n" if whole else "")
    rows = []
    for number, line in enumerate(whole.split("\n") if whole else [], start=1):
        try:
            row = json.loads(line)
            missing = [name for name in row["key"] if name not in row]
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise FileError(f"line {number} is not a study row ({error})", file=str(path)) from error
        if missing:
            raise FileError(f"line {number} lacks {', '.join(missing)}", file=str(path))
        rows.append(row)
    return rows


def study_table(rows: Sequence[Row], columns: Mapping[str, str], command: str) -> str:
    """Markdown table of rows. columns: heading -> dotted path into the row, with an optional format (`ease_mm.waist:+.1f`). command: what made it."""
    lines = [f"Made by `{command}`.", "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(_cell(row, path) for path in columns.values()) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def write_study_table(path: str | Path, title: str, rows: Sequence[Row], columns: Mapping[str, str], command: str) -> Path:
    """A page `# title` with the table."""
    return write_atomic(path, f"# {title}\n\n{study_table(rows, columns, command)}")


def _cell(row: Row, path: str) -> str:
    path, _, form = path.partition(":")
    value: Any = row
    for name in path.split("."):
        value = value.get(name) if isinstance(value, Mapping) else None
    if value is None:
        return "-"
    return (f"{value:{form}}" if form else str(value)).replace("|", "\\|")


def _key_text(row: Mapping[str, Any], names: Iterable[str]) -> str:
    return json.dumps({name: row[name] for name in names}, sort_keys=True, allow_nan=False)


def _append(path: Path, row: Row) -> None:
    line = json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a", encoding="utf-8") as file:
            file.write(line)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise FileError(f"cannot write: {error.strerror or error}", file=str(path)) from error
