"""The YAML door: what it reads, and that every trap is refused at once with file and line."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from garmentcad.errors import FileError
from garmentcad.io.yaml_file import MAX_BYTES, parse_yaml, read_yaml


def test_plain_data() -> None:
    text = """
    # a comment
    no: yes
    on: off
    time: 1:30
    date: 2020-01-01
    numbers: [1, -2, +3, 010, 1e3, .5, 1., -2.5e-3, 1_000, 0x10, 0o7]
    words: [true, False, null, ~, 'true', "1", 1.2.3, "", nan, inf]
    block: |
      two
      lines
    list:
    - a: 1
      b: [[1, 2], {c: d}]
    -
    """
    assert parse_yaml(text, "f") == {
        "no": "yes",
        "on": "off",
        "time": "1:30",
        "date": "2020-01-01",
        "numbers": [1, -2, 3, 10, 1000.0, 0.5, 1.0, -0.0025, "1_000", "0x10", "0o7"],
        "words": [True, False, None, None, "true", "1", "1.2.3", "", "nan", "inf"],
        "block": "two\nlines\n",
        "list": [{"a": 1, "b": [[1, 2], {"c": "d"}]}, None],
    }
    assert isinstance(parse_yaml("1e3", "f"), float)
    assert isinstance(parse_yaml("1000", "f"), int)


TRAPS: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "the file is empty"),
    "only a comment": ("# nothing\n", "the file is empty"),
    "not UTF-8": (b"a: 1\nb: \xff\xfe\n", "line 2: byte 8 is not UTF-8"),
    "binary": (bytes(range(256)) * 40, "line"),
    "null bytes": (b"a: 1\n\0\0", "line 2: character '\\x00'"),
    "two documents": ("a: 1\n---\nb: 2\n", "line 2: a second document"),
    "alias": ("a: &x [1]\nb: *x\n", "line 1: anchor &x"),
    "lone alias": ("b: *x\n", "line 1: alias *x"),
    "alias bomb": ("a0: &a0 [x, x]\n" + "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 60)), "line 1: anchor"),
    "merge key": ("a: {b: 1}\nc:\n  <<: *a\n", "alias *a"),
    "python tag": ("a: !!python/object/apply:os.system [ls]\n", "line 1: tag"),
    "str tag": ("a: !!str 1\n", "line 1: tag"),
    "own tag": ("a: !garment 1\n", "line 1: tag"),
    "duplicate key": ("a: 1\nb:\n  c: 1\n  d: 2\n  c: 3\n", "b: line 5: key 'c' stands twice, first on line 3"),
    "number as key": ("1: a\n", "key 1 is not text"),
    "decimal comma": ("a: {b: 0,09, c: 1}\n", "a: line 1: key 9 is not text; write it in quotes, or with a decimal point where it ends a number: 0.09"),
    "no space": ("a: 1\nb:20\nc: 3\n", "line 2: not valid YAML: 'b:20' is no `key: value`"),
    "dash for nothing": ("a: 1\nb: -\n", "line 2: not valid YAML: a dash begins a list"),
    "true as key": ("true: a\n", "key True is not text"),
    "nothing as key": ("~: a\n", "key None is not text"),
    "list as key": ("[1, 2]: a\n", "keys are text"),
    "mapping as key": ("? {a: 1}\n: b\n", "keys are text"),
    "nan": ("a: .nan\n", "a: line 1: .nan is not allowed"),
    "inf": ("a: [1, -.inf]\n", "a.1: line 1: -.inf is not allowed"),
    "too large": ("a: 1e999\n", "1e999 is not allowed"),
    "thousands of digits": ("a: " + "9" * 9000 + "\n", "numbers must be finite"),
    "deep flow lists": ("[" * 100_000, "nested deeper than 32"),
    "deep flow maps": ("{a: " * 100_000, "nested deeper than 32"),
    "deep block lists": ("- " * 100_000, "nested deeper than 32"),
    "deep block maps": ("\n".join(" " * k + "a:" for k in range(1000)), "nested deeper than 32"),
    "deep keys": ("? " * 100_000, "keys are text"),
    "many values": ("[" + "1," * 60_000 + "]", "more than 50000 values"),
    "open list": ("a: [1, 2\n", "line 2: not valid YAML"),
    "tab": ("a:\n\t- 1\n", "line 2: not valid YAML: a tab indents this line; YAML is indented by spaces"),
    "tab after spaces": ("a:\n  b: 1\n \tc: 1\n", "line 3: not valid YAML: a tab"),
    "tab inside": ("a:\n  b: 1\n  @\tc: 1\n", "line 3: not valid YAML: while"),
    "two colons": ("a: b: c\n", "line 1: not valid YAML"),
    "open quote": ("a: 'b\n", "not valid YAML"),
    "no value": ("@\n", "not valid YAML"),
}


@pytest.mark.parametrize("trap", TRAPS, ids=str)
def test_traps_are_refused(trap: str, tmp_path: Path) -> None:
    content, message = TRAPS[trap]
    path = tmp_path / "trap.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(FileError) as caught:
        read_yaml(path)
    assert message in str(caught.value)
    assert caught.value.file == str(path)


def test_files_that_are_none(tmp_path: Path) -> None:
    huge = tmp_path / "huge.yaml"
    with huge.open("wb") as stream:
        stream.truncate(100_000_000)  # a sparse file: the size is looked at, nothing is read
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)  # reading it would wait for ever
    for path, message in (
        (huge, f"100000000 bytes; at most {MAX_BYTES}"), (tmp_path, "a folder"), (tmp_path / "none.yaml", "no such file"), (pipe, "not a regular file"),
        ("a\0b", "cannot be read"), (tmp_path / ("x" * 5000), "cannot be read"),
    ):  # fmt: skip
        with pytest.raises(FileError) as caught:
            read_yaml(path)
        assert message in str(caught.value)
        assert caught.value.file == str(path)


def test_byte_order_mark_and_windows_lines() -> None:
    assert parse_yaml("\ufeffa: 1\r\nb: 2\r\n", "f") == {"a": 1, "b": 2}


words = st.text(st.characters(codec="ascii"), max_size=8)
plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**15), 10**15) | st.floats(allow_nan=False, allow_infinity=False) | words,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.from_regex(r"[a-z]{1,5}\Z"), inner, max_size=4),
    max_leaves=20,
)


@given(plain)
def test_agrees_with_the_standard_loader_on_quoted_data(data: Any) -> None:
    """An independent dump in which every text is quoted must come back as it was."""

    class Quoted(yaml.SafeDumper):
        def ignore_aliases(self, data: Any) -> bool:
            return True

    Quoted.add_representer(str, lambda dumper, text: dumper.represent_scalar("tag:yaml.org,2002:str", text, style='"'))
    keys_plain = yaml.dump({"data": data}, Dumper=Quoted)
    assert parse_yaml(keys_plain, "f") == {"data": data}


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(text: str) -> None:
    with contextlib.suppress(FileError):  # any other exception is a fault of the reader
        parse_yaml(text, "f")
