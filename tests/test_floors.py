"""Imports go down only (DESIGN section 2): a file may import its own package and lower floors, never a higher one nor a neighbour on the same floor."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent / "garmentcad"
FLOORS = {
    "errors": 0, "schema_version": 0,
    "units": 1, "arrays": 1, "kernel_cache": 0,
    "geometry": 2,
    "pattern": 3, "fabric": 3, "mannequin": 3,
    "io": 4, "modeller": 4, "cloth": 4,
    "forces": 5, "contact": 5, "constraints": 5, "placement": 5,
    "solve": 6, "analysis": 6,
    "simulation": 7, "check": 7,
    "rigs": 8, "export": 8, "bench": 8,
    "batch": 9, "regression": 9, "lab": 10, "cli": 11, "__main__": 12,
}  # fmt: skip
FILES = sorted(path for path in ROOT.rglob("*.py") if path != ROOT / "__init__.py")


def unit_of(path: Path) -> str:
    return path.relative_to(ROOT).parts[0].removesuffix(".py")


def imported_units(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        names: list[str] = []
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: write imports in full"
            if node.module == "garmentcad":
                names = [f"garmentcad.{alias.name}" for alias in node.names if alias.name != "__version__"]
            elif node.module and node.module.startswith("garmentcad."):
                names = [node.module]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names if alias.name.startswith("garmentcad.")]
        found |= {name.split(".")[1] for name in names}
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_go_down(path: Path) -> None:
    own = unit_of(path)
    assert own in FLOORS, f"{own} has no floor: add it to DESIGN section 2 and to this table"
    for name in imported_units(path) - {own}:
        assert FLOORS[name] < FLOORS[own], f"{path} (floor {FLOORS[own]}) imports garmentcad.{name} (floor {FLOORS[name]})"


def test_every_package_is_found() -> None:
    assert {unit_of(path) for path in FILES} <= set(FLOORS)
    assert len(FILES) > 20
