"""The door for JSON: what is refused, by file and line, before and after parsing."""

from __future__ import annotations

from pathlib import Path

import pytest

from garmentcad.errors import FileError
from garmentcad.io.json_file import MAX_BYTES, MAX_DEPTH, read_json


def test_plain_content(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b'\xef\xbb\xbf{"a": [1, 2.5, -3e2, true, null, "x\\"]}"]}')
    assert read_json(path) == {"a": [1, 2.5, -300.0, True, None, 'x"]}']}


def test_depth_at_the_cap(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b"[" * MAX_DEPTH + b"]" * MAX_DEPTH)
    assert isinstance(read_json(path), list)


REFUSED = [
    (b"", "empty"),
    (b'{"a": 1,\n "a": 2}', "key 'a' stands twice"),
    (b'{"a": NaN}', "NaN is not allowed"),
    (b"[-Infinity]", "-Infinity is not allowed"),
    (b"[1e999]", "1e999 is not allowed; numbers must be finite"),
    (b"[" + b"7" * 5000 + b"]", "a whole number of 5000 digits"),
    (b"\n\n[1, 2", "line 3: not valid JSON"),
    (b'// a comment\n{"a": 1}', "line 1: not valid JSON"),
    (b'[1,\n"\xff"]', "line 2: byte 5 is not UTF-8"),
    (b'{"a": 1}'.decode().encode("utf-16"), "not UTF-8"),
    (b'["a\x01"]', "not valid JSON"),
    (b"\n" + b"[" * 100_000, "line 2: nested deeper than 32"),
    (b'{"a":' * 100_000, "nested deeper than 32"),
    (b'"' + b"[" * 100_000, "not valid JSON"),  # a text that never ends
    (b'["\\"' + b"[" * 100_000, "not valid JSON"),
    (b'["\\\\"' + b"[" * 100_000, "nested deeper than 32"),  # a text that ends with a backslash
    (b'"\\"' * 100_000, "not valid JSON"),
]


@pytest.mark.parametrize(("content", "says"), REFUSED, ids=[says for _, says in REFUSED])
def test_refused(content: bytes, says: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(FileError, match=r"bad\.json") as caught:
        read_json(path)
    assert says in str(caught.value)
    assert len(str(caught.value)) < 500


def test_brackets_in_a_text_are_no_depth(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b'["' + b"[{" * 1000 + b'\\""]')
    assert read_json(path) == ["[{" * 1000 + '"']


def test_size_is_seen_before_anything_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    with path.open("wb") as stream:
        stream.truncate(MAX_BYTES + 1)
    with pytest.raises(FileError, match=f"at most {MAX_BYTES}"):
        read_json(path)
