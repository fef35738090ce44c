"""What the howtos show runs: a garment test of the README's garment is read; from a GarmentCode file to a garment under test, command by command."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from typing import Any

import pytest
from command import garmentcad_here
from test_readme import block

from garmentcad.check.examine import examine
from garmentcad.contact.contact import Contact
from garmentcad.io.garment_test_file import read_garment_tests
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.spec_file import read_spec
from garmentcad.regression.trial import job_of
from garmentcad.units import GRAVITY_M_S2

DOCS = Path(__file__).resolve().parent.parent / "docs"


def test_garment_test_of_the_howto(tmp_path: Path) -> None:
    first, more = re.findall(r"```yaml\n(.*?)```", (DOCS / "howto" / "test-a-garment.md").read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "a-line.yaml").write_text(block("yaml"))
    path = tmp_path / "a-line.garment-test.yaml"
    path.write_text(first + more)
    (case,) = read_garment_tests(path)
    job = job_of(case)
    assert (job.pattern.name, job.grid_mm) == ("a-line", 20.0)
    assert "hem.nodes" in case.test.baseline


@pytest.mark.parametrize("mannequin", [None, "man-100"])
def test_garment_of_the_howto_is_clean(mannequin: str | None, tmp_path: Path) -> None:
    """Its parts, joined, are a garment that holds on the bodies that the page names (`holds-nowhere` is a warning of the doctor)."""
    path = tmp_path / "apron.yaml"
    path.write_text("".join(re.findall(r"```yaml\n(.*?)```", (DOCS / "howto" / "add-a-garment.md").read_text(encoding="utf-8"), re.DOTALL)))
    assert [str(finding) for finding in examine(path, mannequin)] == []


def test_rigs_called_from_python(capsys: pytest.CaptureFixture[str]) -> None:
    """The example of docs/rigs.md up to the slower ones, whose names exist: the tester prints the sheet."""
    (page,) = re.findall(r"```python\n(.*?)```", (DOCS / "rigs.md").read_text(encoding="utf-8"), re.DOTALL)
    quick, slow = page[: page.index('print("a heart')], page[page.index('print("a heart') :]
    names: dict[str, Any] = {}
    exec(quick, names)
    assert names["printed"]["G.warp"] == pytest.approx(names["sheet"].number("G.warp"), rel=0.02)
    assert {node.func.id for node in ast.walk(ast.parse(slow)) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)} - {"print"} <= set(names)
    assert re.search(r"bending length of the warp 2\d\.", capsys.readouterr().out)


def test_garment_scripted_in_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The page's Python, joined, on 40 mm: no finding, a drape of the sheet and the body that it is given, and the same garment as YAML. The top presses on the
    body at 8 m/s while tension is soft and stays where it is: to look for candidates for all of that took a look in each of those steps, 810 in all."""
    page = "".join(re.findall(r"```python\n(.*?)```", (DOCS / "howto" / "script-a-garment.md").read_text(encoding="utf-8"), re.DOTALL))
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    looks, find = [], Contact._find_pairs
    monkeypatch.setattr(Contact, "_find_pairs", lambda self, state, reserve_m: (looks.append(state.step), find(self, state, reserve_m)))
    exec(page.replace("grid_mm=20", "grid_mm=40"), names)
    assert len(looks) < names["result"].report["steps"] / 20
    assert read_spec("tube-top.yaml") == names["spec"]
    report = names["result"].report
    assert (report["status"], report["self_intersections"], report["mannequin"]) == ("converged", 0, "woman-80")
    area_m2 = 2.0 * 0.3 * (1e-3 * read_mannequin("woman-80").measurements_mm["bust"] / 2.0 - 0.02)
    assert names["cloth"].masses.sum() == pytest.approx(1e-2 * 1.2 * names["knit"].W.value * area_m2, rel=1e-9)
    assert re.fullmatch(r"widest strain of the warp 0\.\d+\ntop edge 1\.\d+ m above the floor\n", capsys.readouterr().out), "and no finding"


def test_cloth_and_forces_in_python() -> None:
    """Python of the pages on cloth and forces, joined: all forces together are weight and wind, since internal ones add up to nothing."""
    pages = [(DOCS / name).read_text(encoding="utf-8") for name in ("cloth.md", "forces.md", "howto/add-a-force.md")]
    names: dict[str, Any] = {}
    exec("".join(re.findall(r"```python\n(.*?)```", "".join(pages), re.DOTALL)).replace("grid_mm=10.0", "grid_mm=40.0"), names)
    mass = names["cloth"].masses.sum()
    assert names["welded"].particle_count == names["particle"].max() + 1
    assert names["out"].sum(axis=0) == pytest.approx([0.0, -GRAVITY_M_S2 * mass, 1.0 * mass], abs=1e-9)
    assert 1e-6 < names["dt"] < 1e-2


def run_page(name: str, folder: Path) -> list[str]:
    """Run every command of a page in the folder, on 40 mm and with six lays at most; what they print. A command that fails fails the test."""
    page = (DOCS / "howto" / name).read_text(encoding="utf-8")
    printed = []
    for line in "".join(re.findall(r"```sh\n(.*?)```", page, re.DOTALL)).splitlines():
        program, *words = line.replace("--grid 20", "--grid 40").replace("--lays 10", "--lays 6").split()
        assert program == "garmentcad"
        run = garmentcad_here(*words, folder=folder)
        assert run.returncode == 0, f"{line}\n{run.stdout}\n{run.stderr}"
        printed.append(run.stdout)
    return printed


def test_from_a_garmentcode_file_to_a_garment_under_test(tmp_path: Path) -> None:
    page = (DOCS / "howto" / "garmentcode-to-test.md").read_text(encoding="utf-8")
    (pattern,), (test,) = (re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL) for language in ("json", "yaml"))
    (tmp_path / "skirt_specification.json").write_text(pattern)
    (tmp_path / "skirt.garment-test.yaml").write_text(test.replace("grid_mm: 20", "grid_mm: 40"))
    printed = run_page("garmentcode-to-test.md", tmp_path)
    report = json.loads((tmp_path / "out" / "skirt" / "report.json").read_text())
    assert (report["status"], report["self_intersections"], report["mannequin_intersections"]) == ("converged", 0, 0)
    assert "seat" in (tmp_path / "out" / "skirt-fit.csv").read_text()
    assert "hem" in printed[2]
    # What the page says of a longer skirt: the hem's points go down, and the test fails by the hem. Six lays tell it surely;
    # of three, Student's factor is so large (82, of six 10) that the tolerance is as wide as the change.
    spec = tmp_path / "skirt.yaml"
    text = spec.read_text()
    longer = text.replace("[0.0, 0.0]", "[0.0, -10.0]").replace("[600.0, 0.0]", "[600.0, -10.0]")
    assert text.count("[600.0, 0.0]") == 2
    spec.write_text(longer)
    run = garmentcad_here("test", "skirt.garment-test.yaml", folder=tmp_path)
    assert run.returncode == 4, run.stdout
    assert re.search(r"hem_height_mm.*FAILS", run.stdout), run.stdout
