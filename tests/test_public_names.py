"""What users import: names that load when they are used are the names that type checkers and editors see."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path

import garmentcad

SOURCE = Path(garmentcad.__file__)


def test_type_checkers_see_what_is_loaded() -> None:
    """Everything came as `Any` to them."""
    tree = ast.parse(SOURCE.read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    assert isinstance(block.test, ast.Name)
    assert block.test.id == "TYPE_CHECKING"
    seen = {alias.asname: (node.module, alias.name) for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert seen.keys() | {"__version__"} == set(garmentcad.__all__)
    for name, (module, original) in seen.items():
        assert getattr(garmentcad, name) is getattr(import_module(str(module)), original)


def test_the_package_says_that_it_is_typed() -> None:
    assert (SOURCE.parent / "py.typed").read_bytes() == b""
