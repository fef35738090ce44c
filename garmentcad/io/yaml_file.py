"""The door for YAML files. Reads the plain subset that garments, fabrics and tests need and refuses everything else with file and line.

Only mappings with text keys, lists, and scalars: text, true/false, null, whole numbers and floats. `no`, `on`, `1:30`, dates and `0x10` stay text, `1e3` is a
number. Refused: anchors and aliases (a small file can stand for a huge one), tags, duplicate keys, nan and inf, several documents, deep nesting, big files.
"""

from __future__ import annotations

import math
import re
import stat
from pathlib import Path
from typing import Any

import yaml

from garmentcad.errors import FileError, InputError

ENDINGS = (".yaml", ".yml")
# The parser of libyaml is six times as fast; a build of PyYAML may lack it. Its events alone are used: its composer recurses, and dies at great depth.
_Events: Any = yaml._yaml.CParser if yaml.__with_libyaml__ else yaml.SafeLoader

MAX_BYTES = 1_000_000
MAX_DEPTH = 32
MAX_NODES = 50_000
_TOO_DEEP = f"nested deeper than {MAX_DEPTH} levels; that is the cap"

_INTEGER = re.compile(r"[-+]?[0-9]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF|nan|NaN|NAN)")
_NOT_ALLOWED = yaml.reader.Reader.NON_PRINTABLE
_WORDS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False} | dict.fromkeys(("null", "Null", "NULL", "~", ""))


def read_bytes(path: str | Path, max_bytes: int = MAX_BYTES) -> bytes:
    """Content of a regular file of at most `max_bytes`; the size is looked at before anything is read. FileError otherwise."""
    file = str(path)
    try:
        status = Path(path).stat()
        if not stat.S_ISREG(status.st_mode):
            raise FileError(f"this is {'a folder' if stat.S_ISDIR(status.st_mode) else 'not a regular file'}; a file is wanted", file=file)
        if status.st_size > max_bytes:
            raise FileError(f"the file has {status.st_size} bytes; at most {max_bytes} are read", file=file)
        with Path(path).open("rb") as stream:
            return stream.read(max_bytes)
    except FileNotFoundError:
        raise FileError("there is no such file", file=file) from None
    except (OSError, ValueError) as fault:  # ValueError: a null byte in the name
        raise FileError(f"cannot be read: {fault}", file=file) from None


def refuse_no_yaml(path: str | Path, key: str | None = None) -> None:
    """InputError where what is to be written as YAML would have another ending, by which no reader would know it. key: what named the file."""
    path = Path(path)
    if path.name and path.suffix not in ENDINGS:
        raise InputError(f"cannot write '{path.suffix or path.name}'; allowed are {', '.join(ENDINGS)}", file=str(path), key=key)


def read_yaml(path: str | Path) -> Any:
    """The single document of a YAML file as dicts, lists, str, bool, int, float and None. FileError (with file and line) for all that is refused."""
    file = str(path)
    raw = read_bytes(path)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        line = raw.count(b"\n", 0, fault.start) + 1
        raise FileError(f"line {line}: byte {fault.start} is not UTF-8; YAML files are UTF-8 text", file=file) from None
    return parse_yaml(text, file)


def parse_yaml(text: str, file: str) -> Any:
    """As `read_yaml`, from text; `file` names the source in messages."""
    builder = _Builder(file)
    if strange := _NOT_ALLOWED.search(text):  # here, because the two parsers count it in characters and in bytes
        line = text.count("\n", 0, strange.start()) + 1
        raise FileError(f"line {line}: character {strange.group()!r} is not allowed; YAML files are UTF-8 text", file=file)
    try:
        # Events, not nodes: the event parser keeps its own stack, so that depth is seen before any recursion; the composer would recurse.
        for event in yaml.parse(text, Loader=_Events):
            builder.take(event)
    except yaml.MarkedYAMLError as fault:
        what = " ".join(part for part in (fault.context, fault.problem) if part)
        no_colon = "scanning a simple key" in what  # noticed on the line behind it
        mark = fault.context_mark if no_colon else fault.problem_mark or fault.context_mark
        said = _TOO_DEEP if "maximum nesting depth" in what else f"not valid YAML: {what}"  # newer libyaml counts levels itself, and ahead of its events
        marked = "".join(text.splitlines()[mark.line : mark.line + 1]) if mark else ""
        if "\t" in marked[: len(marked) - len(marked.lstrip())]:
            said = "not valid YAML: a tab indents this line; YAML is indented by spaces"
        elif no_colon:
            said = f"not valid YAML: {marked.strip()[:60]!r} is no `key: value`; a colon and a space are wanted between them"
        elif "sequence entries are not allowed" in what:
            said = "not valid YAML: a dash begins a list, on a line of its own; a value that is not known is left out"
        raise FileError(f"line {mark.line + 1 if mark else '?'}: {said}", file=file) from None
    except yaml.YAMLError as fault:  # what else the parser of libyaml may say has no line
        raise FileError(f"not valid YAML: {fault}", file=file) from None
    if builder.documents == 0:
        raise FileError("the file is empty; a YAML document is wanted", file=file)
    return builder.root


class _Builder:
    """Builds plain data from parser events with an explicit stack."""

    def __init__(self, file: str) -> None:
        self.file, self.documents, self.nodes = file, 0, 0
        self.root: Any = None
        self.stack: list[_Open] = []

    def refuse(self, event: Any, message: str) -> FileError:
        key = ".".join(label for level in self.stack if (label := level.label()))
        return FileError(f"line {event.start_mark.line + 1}: {message}", file=self.file, key=key or None)

    def take(self, event: yaml.Event) -> None:
        if isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                raise self.refuse(event, "a second document starts here (---); one document a file is allowed")
        elif isinstance(event, yaml.AliasEvent):
            raise self.refuse(event, f"alias *{event.anchor}; anchors and aliases are not allowed, write the value out")
        elif isinstance(event, yaml.NodeEvent):
            self.take_node(event)
        elif isinstance(event, yaml.CollectionEndEvent):
            level = self.stack.pop()
            self.put(event, level.value)

    def take_node(self, event: Any) -> None:
        self.nodes += 1
        if self.nodes > MAX_NODES:
            raise self.refuse(event, f"more than {MAX_NODES} values; that is the cap for a file")
        if event.anchor is not None:
            raise self.refuse(event, f"anchor &{event.anchor}; anchors and aliases are not allowed, write the value out")
        if event.tag is not None:
            raise self.refuse(event, f"tag {event.tag}; tags are not allowed")
        if isinstance(event, yaml.ScalarEvent):
            self.put(event, self.scalar(event))
            return
        if self.stack and self.stack[-1].wants_key():
            raise self.refuse(event, "a list or mapping stands where a key is wanted; keys are text")
        if len(self.stack) == MAX_DEPTH:
            raise FileError(f"line {event.start_mark.line + 1}: {_TOO_DEEP}", file=self.file)
        self.stack.append(_Open({} if isinstance(event, yaml.MappingStartEvent) else []))

    def put(self, event: Any, value: Any) -> None:
        if not self.stack:
            self.root = value
            return
        level = self.stack[-1]
        if isinstance(level.value, list):
            level.value.append(value)
        elif level.wants_key():
            if not isinstance(value, str):
                raise self.refuse(event, f"key {value!r} is not text; write it in quotes{level.point(event, value)}")
            if value in level.lines:
                raise self.refuse(event, f"key {value!r} stands twice, first on line {level.lines[value]}; each key may stand once")
            level.lines[value] = event.start_mark.line + 1
            level.key = value
        else:
            level.value[level.key] = value
            level.key = None

    def scalar(self, event: Any) -> Any:
        if event.style:  # quoted or block text
            return event.value
        try:
            return plain_scalar(event.value)
        except ValueError as fault:
            raise self.refuse(event, str(fault)) from None


def plain_scalar(text: str) -> Any:
    """Meaning of an unquoted scalar: true/false, null, a whole number, a float, or the text itself. ValueError for nan and numbers that are not finite."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text) and len(text) <= 18:
        return int(text)
    if _FLOAT.fullmatch(text):
        number = float(text)
        if math.isfinite(number):
            return number
    elif not _NOT_FINITE.fullmatch(text):
        return text
    raise ValueError(f"{text[:40]} is not allowed; numbers must be finite")


class _Open:
    """A mapping or list that is still being filled."""

    def __init__(self, value: dict[str, Any] | list[Any]) -> None:
        self.value: Any = value
        self.key: str | None = None
        self.lines: dict[str, int] = {}

    def wants_key(self) -> bool:
        return isinstance(self.value, dict) and self.key is None

    def point(self, event: Any, value: Any) -> str:
        """The end of a refused key where it may be the end of a number with a decimal comma: `{warp: 0,09}` is warp 0 and a key 09."""
        key, last = next(reversed(self.value.items()), ("", None))
        beside = type(value) is type(last) is int and self.lines[key] == event.start_mark.line + 1
        return f", or with a decimal point where it ends a number: {last}.{event.value}" if beside else ""

    def label(self) -> str:
        return str(len(self.value)) if isinstance(self.value, list) else self.key or ""
