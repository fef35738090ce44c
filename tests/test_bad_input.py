"""Bad input, table by table (DESIGN section 10): each row is a file that must be refused with its name, its key path, what came and what is allowed.

To add rows: write a list of `Case` for your format and add it to CASES; to add a format: give it a reader in READERS.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from garmentcad.errors import InputError
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft

BODY = {"waist": 720.0, "hip": 960.0, "waist_height": 1040.0}

GOOD_SPEC = b"""\
schema: 1
units: mm
name: square
fabric: cotton-shirting
mannequin: woman-88
parameters:
  length: {value: 500, range: [300, 700]}
panels:
  front:
    points:
      a: [0, 0]
      b: [waist / 2, 0]
      c: [waist / 2, length]
      d: [0, length]
    edges:
      - {name: bottom, from: a, to: b, role: hem}
      - {name: right, from: b, to: c}
      - {name: top, from: c, to: d}
      - {name: left, from: d, to: a}
    placement:
      wrap: {part: torso, angle: 0, height: waist_height}
seams:
  - {name: tube, a: [front.left.d, front.left.a], b: [front.right.c, front.right.b]}
"""


class Case(NamedTuple):
    """kind: which reader; content: bytes of the file (None where `make` builds what stands at the path); key: dotted key path that the message names
    (None: the file as a whole); says: parts of the message, what came and what is allowed among them."""

    kind: str
    name: str
    content: bytes | None
    key: str | None
    says: tuple[str, ...]
    make: Callable[[Path], None] | None = None


def spec(name: str, old: bytes, new: bytes, key: str | None, *says: str) -> Case:
    """A good spec with one thing changed."""
    assert GOOD_SPEC.count(old) >= 1, name
    return Case("spec", name, GOOD_SPEC.replace(old, new, 1), key, says)


def sparse(path: Path) -> None:
    with path.open("wb") as stream:
        stream.truncate(100_000_000)


YAML_CASES = [
    Case("spec", "no file", None, None, ("there is no such file",), lambda path: None),
    Case("spec", "a folder", None, None, ("a folder", "a file is wanted"), Path.mkdir),
    Case("spec", "a pipe", None, None, ("not a regular file",), os.mkfifo),
    Case("spec", "100 MB", None, None, ("100000000 bytes", "at most 1000000"), sparse),
    Case("spec", "empty", b"", None, ("empty",)),
    Case("spec", "binary", bytes(range(256)) * 64, None, ("line",)),
    Case("spec", "not UTF-8", GOOD_SPEC.replace(b"square", b"squ\xe4re"), None, ("line 3", "UTF-8")),
    Case("spec", "null byte", GOOD_SPEC.replace(b"square", b"squ\0re"), None, ("line 3", "not allowed")),
    Case("spec", "a list", b"- 1\n- 2\n", None, ("a mapping", "came [1, 2]")),
    Case("spec", "a word", b"skirt\n", None, ("a mapping", "came 'skirt'")),
    Case("spec", "not YAML", b"panels: [a, b\n", None, ("line 2", "not valid YAML")),
    Case("spec", "tab", b"panels:\n\tfront: 1\n", None, ("line 2", "not valid YAML")),
    Case("spec", "deep lists", b"[" * 100_000, None, ("nested deeper", "32")),
    Case("spec", "deep block lists", b"- " * 100_000, None, ("nested deeper", "32")),
    Case("spec", "deep maps", b"{a: " * 100_000, None, ("nested deeper", "32")),
    Case("spec", "alias bomb", b"a: &a [x, x]\n" + b"".join(b"b%d: &b%d [*a, *a]\n" % (k, k) for k in range(50)), "a", ("anchor &a", "not allowed")),
    Case("spec", "many values", b"a: [" + b"1," * 60_000 + b"1]", "a.49997", ("more than 50000 values",)),
    Case("spec", "python object", b"name: !!python/object/apply:os.getcwd []\n", "name", ("tag", "not allowed")),
    Case("spec", "two documents", GOOD_SPEC + b"---\na: 1\n", None, ("second document", "one document a file")),
    Case("spec", "duplicate key", GOOD_SPEC + b"name: again\n", None, ("line 24", "'name' stands twice", "line 3")),
    Case("spec", "number as key", GOOD_SPEC + b"1: x\n", None, ("key 1 is not text",)),
]

SPEC_CASES = [
    spec("no schema", b"schema: 1\n", b"", "schema", "missing", "schema: 1"),
    spec("no units", b"units: mm\n", b"", "units", "missing", "units: mm"),
    spec("inches", b"units: mm", b"units: inch", "units", "'mm'", "came 'inch'"),
    spec("schema of a truth", b"schema: 1", b"schema: true", "schema", "should be 1", "came 'true'"),
    spec("newer schema", b"schema: 1", b"schema: 2", "schema", "should be 1", "came 2"),
    spec("unknown key", b"seams:", b"seems:", "seems", "did you mean 'seams'", "Allowed:"),
    spec("unknown key inside", b"role:", b"rolle:", "panels.front.edges.0.rolle", "did you mean 'role'"),
    spec("missing key", b"name: square\n", b"", "name", "missing"),
    spec("no panels", GOOD_SPEC[GOOD_SPEC.index(b"panels:") :], b"panels: {}\n", "panels", "at least 1"),
    spec("panel is a text", b"points:", b"points: here\n    x:", "panels.front.x", "unknown key"),
    spec("name is a number", b"name: square", b"name: 12", "name", "valid string", "came 12"),
    spec("nan", b"value: 500", b"value: .nan", "parameters.length.value", "line 7", "finite"),
    spec("inf", b"value: 500", b"value: 1e999", "parameters.length.value", "line 7", "finite"),
    spec("true as number", b"value: 500", b"value: true", "parameters.length.value", "a number or an expression", "came true"),
    spec("out of range", b"value: 500", b"value: 900", "parameters.length.value", "came 900", "300 to 700"),
    spec("import", b"value: 500", b"value: __import__('os').getcwd()", "parameters.length.value", "allowed are numbers"),
    spec("huge power", b"value: 500", b"value: 9 ** 9 ** 9", "parameters.length.value", "exponent", "16"),
    spec("zero division", b"value: 500", b"value: 1 / 0", "parameters.length.value", "divides by zero"),
    spec("unknown name", b"waist / 2, 0", b"waste / 2, 0", "panels.front.points.b.0", "unknown name 'waste'", "did you mean 'waist'"),
    spec("huge coordinate", b"waist / 2, 0", b"1e8, 0", "panels.front.points.b.0", "came 1e+08", "-20000 to 20000"),
    spec("one coordinate", b"a: [0, 0]", b"a: [0]", "panels.front.points.a.1", "missing"),
    spec("unknown point", b"from: a, to: b", b"from: a, to: z", "panels.front.edges.0.to", "no point is called 'z'", "Allowed: a, b, c, d"),
    spec("open outline", b"to: b, role", b"to: c, role", "panels.front.edges.1.from", "outline is open", "mm away"),
    spec("no area", b"c: [waist / 2, length]\n      d: [0, length]", b"c: [waist, 0]\n      d: [2 * waist, 0]", "panels.front.edges", "encloses"),
    spec("unknown part", b"torso", b"trunk", "panels.front.placement.wrap.part", "'torso'", "came 'trunk'"),
    spec("no placement", b"wrap: {part: torso, angle: 0, height: waist_height}", b"wrap: null", "panels.front.placement", "exactly one of"),
    spec("unknown panel", b"front.left.d", b"frond.left.d", "seams.tube.a.0", "'frond'", "did you mean 'front'"),
    spec("unknown edge", b"front.left.d", b"front.lefd.d", "seams.tube.a.0", "'lefd'", "did you mean 'left'"),
    spec("point not on edge", b"front.left.d", b"front.left.c", "seams.tube.a.0", "does not end at 'c'", "Allowed: a, d"),
    spec("no path", b"front.left.d, front.left.a", b"front.left.a, front.left.a", "seams.tube.a", "no way along the outline"),
    spec("short seam end", b"front.left.d", b"front.left", "seams.tube.a.0", "panel.edge.point", "came 'front.left'"),
    spec("closures", b"seams:", b"closures: [zip]\nseams:", "closures.0", "a mapping is wanted, came 'zip'"),
]

REFERENCE_CASES = [
    Case("reference", name, GOOD_SPEC.replace(b"fabric: cotton-shirting", b"fabric: " + text), None, says)
    for name, text, says in (
        ("unknown fabric", b"cotton-shirtng", ("'cotton-shirtng'", "did you mean 'cotton-shirting'", "Allowed:")),
        ("above", b"../secret.yaml", ("'../secret.yaml'", "allowed are a shipped name or a file in the folder")),
        ("hidden above", b"a/../../secret.yaml", ("is refused", "allowed are")),
        ("absolute", b"/etc/passwd", ("'/etc/passwd'", "allowed are")),
        ("home", b"~/secret.yaml", ("does not exist", "allowed are")),
        ("backslash", b"..\\secret.yaml", ("is refused", "allowed are")),
        ("missing file", b"none.yaml", ("'none.yaml'", "does not exist")),
        ("link out", b"link.yaml", ("leads out", "allowed are")),
        ("empty", b"''", ("''", "allowed are")),
    )
]

CASES = [*YAML_CASES, *SPEC_CASES, *REFERENCE_CASES]


def read_and_draft(path: Path) -> None:
    draft(read_spec(path), BODY)


def follow_reference(path: Path) -> None:
    resolve_reference(read_spec(path).fabric, "fabrics", path.parent)


READERS: dict[str, Callable[[Path], None]] = {"spec": read_and_draft, "reference": follow_reference}


def place(case: Case, folder: Path) -> Path:
    """The bad file of a case, in its own folder, with a file outside of it that must not be reached."""
    (folder / "secret.yaml").write_text("secret: 1\n")
    (folder / "in").mkdir()
    (folder / "in" / "link.yaml").symlink_to(folder / "secret.yaml")
    path = folder / "in" / "bad.yaml"
    if case.make is not None:
        case.make(path)
    else:
        assert case.content is not None
        path.write_bytes(case.content)
    return path


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.kind}: {case.name}")
def test_refused(case: Case, tmp_path: Path) -> None:
    path = place(case, tmp_path)
    with pytest.raises(InputError) as caught:
        READERS[case.kind](path)
    message = str(caught.value)
    assert caught.value.key == case.key
    assert len(message) < 1000
    for part in case.says:
        assert part in message
    if case.kind != "reference":  # the reference itself does not know which file it stands in; the command line adds it
        assert caught.value.file == str(path)
        assert message.startswith(str(path))


def test_the_good_spec_is_good(tmp_path: Path) -> None:
    path = tmp_path / "good.yaml"
    path.write_bytes(GOOD_SPEC)
    read_and_draft(path)
    follow_reference(path)
