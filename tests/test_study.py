"""The study runner: a row at once, nothing twice, nothing lost."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from garmentcad.errors import FileError, InputError
from garmentcad.simulation.keeper import Interrupted
from garmentcad.simulation.study import StudyCase, read_rows, run_study, study_table, write_study_table


def case(name: str, fabric: str = "denim", version: str = "1", **parameters) -> StudyCase:
    return StudyCase(name, "5" * 64, fabric, "woman-88", version, parameters)


class Bench:
    """Counts the runs and can be told to fail."""

    def __init__(self, fail: Mapping[str, BaseException] | None = None) -> None:
        self.ran: list[str] = []
        self.fail = fail or {}

    def __call__(self, given: StudyCase) -> dict:
        self.ran.append(given.name)
        if given.name in self.fail:
            raise self.fail[given.name]
        return {"ease_mm": {"waist": 20.0 + len(given.name)}, "status": "converged"}


def test_a_second_run_skips_what_is_there(tmp_path: Path) -> None:
    cases = [case("a"), case("bb"), case("bb", seed=1)]
    first, second = Bench(), Bench()
    run = run_study("wardrobe", cases, first, tmp_path)
    assert first.ran == ["a", "bb", "bb"]
    assert len((tmp_path / "wardrobe.jsonl").read_text().splitlines()) == 3
    again = run_study("wardrobe", cases, second, tmp_path)
    assert second.ran == []
    assert again.rows == run.rows
    assert again.rows[0]["fabric"] == "denim"
    assert again.rows[2]["seed"] == 1


def test_key_says_what_is_another_case(tmp_path: Path) -> None:
    run_study("w", [case("a")], Bench(), tmp_path)
    for other in (case("a", fabric="silk"), case("a", version="2"), case("a", grid_mm=5), StudyCase("a", "6" * 64, "denim", "woman-88", "1")):
        bench = Bench()
        run_study("w", [other], bench, tmp_path)
        assert bench.ran == ["a"]


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), Interrupted("stopped at step 0")])
def test_a_stopped_study_keeps_its_rows_and_goes_on(stop: BaseException, tmp_path: Path) -> None:
    cases = [case("a"), case("b"), case("c")]
    with pytest.raises(KeyboardInterrupt):
        run_study("w", cases, Bench({"b": stop}), tmp_path)
    bench = Bench()
    run = run_study("w", cases, bench, tmp_path)
    assert bench.ran == ["b", "c"]
    assert [row["case"] for row in run.rows] == ["a", "b", "c"]


def test_a_torn_last_line_is_cut_off_and_run_again(tmp_path: Path) -> None:
    run_study("w", [case("a"), case("b")], Bench(), tmp_path)
    path = tmp_path / "w.jsonl"
    path.write_text(path.read_text()[:-20])
    bench = Bench()
    run_study("w", [case("a"), case("b")], bench, tmp_path)
    assert bench.ran == ["b"]
    assert [row["case"] for row in read_rows(path)] == ["a", "b"]


def test_a_refused_case_is_named_and_tried_again(tmp_path: Path) -> None:
    said: list[str] = []
    run = run_study("w", [case("a"), case("b")], Bench({"a": InputError("too long", key="panels")}), tmp_path, say=said.append)
    assert run.failed == {"a": "panels: too long"}
    assert run.ran == ("b",)
    assert "w: a: panels: too long" in said
    bench = Bench()
    run_study("w", [case("a"), case("b")], bench, tmp_path)
    assert bench.ran == ["a"]


def test_only_runs_a_part_but_shows_all_rows(tmp_path: Path) -> None:
    run_study("w", [case("skirt denim")], Bench(), tmp_path)
    bench = Bench()
    run = run_study("w", [case("skirt denim"), case("skirt silk"), case("shirt silk")], bench, tmp_path, only="shirt")
    assert bench.ran == ["shirt silk"]
    assert [row["case"] for row in run.rows] == ["skirt denim", "shirt silk"]


def test_a_name_may_hold_what_other_programs_take_for_a_line_end(tmp_path: Path) -> None:
    path = tmp_path / "odd.jsonl"
    path.write_text(json.dumps({"key": ["case"], "case": "a\u2028b\x85c"}, ensure_ascii=False) + "\n", encoding="utf-8")
    assert [row["case"] for row in read_rows(path)] == ["a\u2028b\x85c"]


def test_bad_rows_are_named_by_line(tmp_path: Path) -> None:
    path = tmp_path / "w.jsonl"
    path.write_text(json.dumps({"case": "a", "key": ["case"]}) + "\n[1]\n")
    with pytest.raises(FileError, match=r"w\.jsonl: line 2"):
        read_rows(path)
    path.write_text(json.dumps({"key": ["case"]}) + "\n")
    with pytest.raises(FileError, match="line 1 lacks case"):
        read_rows(path)


def test_figures_may_not_hide_the_key(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="fabric"):
        run_study("w", [case("a")], lambda given: {"fabric": "other"}, tmp_path)
    with pytest.raises(ValueError, match="not JSON compliant"):
        run_study("w", [case("b")], lambda given: {"x": float("nan")}, tmp_path)


def test_markdown_table(tmp_path: Path) -> None:
    run = run_study("w", [case("a|b"), case("c")], Bench(), tmp_path)
    columns = {"garment": "case", "waist ease, mm": "ease_mm.waist:+.1f", "hip": "ease_mm.hip"}
    table = study_table(run.rows, columns, "make study")
    assert table.splitlines() == [
        "Made by `make study`.",
        "",
        "| garment | waist ease, mm | hip |",
        "|---|---|---|",
        "| a\\|b | +23.0 | - |",
        "| c | +21.0 | - |",
    ]
    page = write_study_table(tmp_path / "w.md", "Wardrobe", run.rows, columns, "make study").read_text()
    assert page == f"# Wardrobe\n\n{table}"
