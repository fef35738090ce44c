"""The garment test of the howto reads, names keys that reports have, and belongs to the garment of the README."""

from __future__ import annotations

import re
from pathlib import Path

from test_readme import block

from garmentcad.io.garment_test_file import read_garment_tests
from garmentcad.regression.trial import job_of

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
