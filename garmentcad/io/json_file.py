"""The door for JSON files. Bytes and depth are looked at before anything is parsed; keys that stand twice, nan, inf and numbers too large are refused."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

from garmentcad.errors import FileError
from garmentcad.io.yaml_file import read_bytes

MAX_BYTES = 2_000_000
MAX_DEPTH = 32
_DIGITS = 30  # of a whole number; no length has more

_MARKS = re.compile(rb'\\.|["\[\]{}]', re.DOTALL)


def read_json(path: str | Path) -> Any:
    """Content of a JSON file as dicts, lists, str, bool, int, float and None. FileError (with file and line) for all that is refused."""
    file = str(path)
    raw = read_bytes(path, MAX_BYTES)
    _check_depth(raw, file)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        line = raw.count(b"\n", 0, fault.start) + 1
        raise FileError(f"line {line}: byte {fault.start} is not UTF-8; JSON files are UTF-8 text", file=file) from None
    if not text.strip():
        raise FileError("the file is empty; a JSON document is wanted", file=file)
    try:
        return json.loads(text, object_pairs_hook=_unique, parse_constant=_refuse_constant, parse_float=_finite, parse_int=_whole)
    except json.JSONDecodeError as fault:
        raise FileError(f"line {fault.lineno}: not valid JSON: {fault.msg}", file=file) from None
    except ValueError as fault:  # from the four functions below
        raise FileError(str(fault), file=file) from None


def _check_depth(raw: bytes, file: str) -> None:
    depth, in_text = 0, False
    for found in _MARKS.finditer(raw):
        mark = found.group()
        if mark == b'"':
            in_text = not in_text
        elif not in_text:
            depth += 1 if mark in (b"[", b"{") else -1 if mark in (b"]", b"}") else 0
            if depth > MAX_DEPTH:
                line = raw.count(b"\n", 0, found.start()) + 1
                raise FileError(f"line {line}: nested deeper than {MAX_DEPTH} levels; that is the cap", file=file)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for key, value in pairs:
        if key in made:
            raise ValueError(f"key {key[:80]!r} stands twice in one mapping; each key may stand once")
        made[key] = value
    return made


def _refuse_constant(text: str) -> float:
    raise ValueError(f"{text} is not allowed; numbers must be finite")


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text[:40]} is not allowed; numbers must be finite")
    return number


def _whole(text: str) -> int:
    if len(text) > _DIGITS:
        raise ValueError(f"a whole number of {len(text)} digits ({text[:20]}...); at most {_DIGITS} are allowed")
    return int(text)
