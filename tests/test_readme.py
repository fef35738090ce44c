"""What the README shows is true: its garment passes the doctor, its names exist, its table of floors is the tested one."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from test_floors import FILES, FLOORS, unit_of

import garmentcad
from garmentcad.check.examine import examine

README = (Path(__file__).resolve().parent.parent / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert found is not None
    return found.group(1)


def test_yaml_garment_passes_the_doctor(tmp_path: Path) -> None:
    path = tmp_path / "tube.yaml"
    path.write_text(block("yaml"))
    assert [str(finding) for finding in examine(str(path))] == []


def test_python_names_exist() -> None:
    nodes = [node for node in ast.walk(ast.parse(block("python"))) if isinstance(node, ast.Attribute)]
    used = {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == "gc"}
    assert used
    for name in garmentcad.__all__:
        assert getattr(garmentcad, name) is not None
    assert used <= set(garmentcad.__all__)


def test_floors_are_those_of_the_test() -> None:
    rows = dict(re.findall(r"^\| (\d+) \| (`.*`) \|$", README, re.MULTILINE))
    shown = {name: int(floor) for floor, names in rows.items() for name in re.findall(r"`(\w+)`", names)}
    there = {unit_of(path) for path in FILES} - {"__main__"}
    assert shown == {name: FLOORS[name] for name in there}


def test_commands_are_in_the_makefile() -> None:
    makefile = (Path(__file__).resolve().parent.parent / "Makefile").read_text()
    for target in re.findall(r"^make (\w+)", README, re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)
