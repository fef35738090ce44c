"""What `garmentcad bench` prints is whole at 60 columns and more: cases that do not fit side by side stand below each other."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from garmentcad.cli.bench import _LINES, _fitting, _table

ROW = {key: 1 if form == "d" else 12345.678 for _, key, form in _LINES}
SHARES = {"steps": 0.7, "detection": 0.2, "stiffness": 0.1}


@pytest.mark.parametrize("width", [60, 80, 400])
def test_no_figure_is_cut_off(width: int) -> None:
    rows = [
        {**ROW, "case": f"case-{k}", "fabric": "polyester-tropical", "grid_mm": 10.0, "threads": 2, "share": SHARES, "status": "converged"} for k in range(9)
    ]
    console = Console(width=width, record=True, file=io.StringIO())
    for group in _fitting(rows, console):
        console.print(_table(group))
    text = console.export_text()
    assert "…" not in text
    assert [f"case-{k}" for k in range(9)] == [word for word in text.replace("┃", " ").split() if word.startswith("case-")]
    assert text.count("polyester-tropical") == 9
