"""Garment tests under pytest: every `NAME.garment-test.yaml` that pytest comes across is one item.

One item a test, not one an assertion: the drape is what costs, and items that shared it would each pay for it where they are spread over processes or chosen
one by one. A failure names all assertions that failed. pytest loads this file at each start: the program itself is imported when a test is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from garmentcad.io.garment_test_file import GarmentTestCase
    from garmentcad.regression.trial import Judgement

ENDING = ".garment-test.yaml"
FOLDER = Path("out") / "garment-tests"


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Files by their ending; other YAML is left alone."""
    return GarmentTestModule.from_parent(parent, path=file_path) if file_path.name.endswith(ENDING) else None


class GarmentTestModule(pytest.File):
    """One file of garment tests."""

    def collect(self) -> Iterator[pytest.Item]:
        from garmentcad.errors import InputError
        from garmentcad.io.garment_test_file import read_garment_tests

        try:
            cases = read_garment_tests(self.path)
        except InputError as error:
            raise self.CollectError(str(error)) from None
        for case in cases:
            yield GarmentTestItem.from_parent(self, name=case.name, case=case)


class GarmentTestItem(pytest.Item):
    """One garment test."""

    def __init__(self, case: GarmentTestCase, **others: Any) -> None:
        super().__init__(**others)
        self.case = case

    def runtest(self) -> None:
        from garmentcad.io.garment_test_file import distinct_names
        from garmentcad.regression.trial import prepare, run_trial

        tests = [item for item in self.session.items if isinstance(item, GarmentTestItem)]
        name = distinct_names([item.case for item in tests])[tests.index(self)]
        judged = run_trial(prepare(self.case), self.config.rootpath / FOLDER / name)
        if not judged.passed:
            raise GarmentTestFailed(judged)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """What failed, without the program's own frames; a fault of the program keeps them."""
        from garmentcad.errors import InputError

        if isinstance(excinfo.value, GarmentTestFailed):
            return failure_text(excinfo.value.judged)
        if isinstance(excinfo.value, InputError):
            return f"refused: {excinfo.value}"
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"garment test {self.name}"


class GarmentTestFailed(Exception):
    """Some assertion of a garment test does not hold."""

    def __init__(self, judged: Judgement) -> None:
        super().__init__(judged.case.name)
        self.judged = judged


def failure_text(judged: Judgement) -> str:
    """The assertions that failed, one a line, how many held, and where the drape lies."""
    if judged.refusal is not None:
        return f"garment test {judged.case.name} was refused: {judged.refusal}"
    failed = [verdict for verdict in judged.verdicts if not verdict.passed]
    lines = [f"garment test {judged.case.name}: {len(failed)} of {len(judged.verdicts)} assertions failed"]
    lines += [f"  {verdict.key}: expected {verdict.expected}, came {verdict.came}" for verdict in failed]
    return "\n".join([*lines, *(f"  see {file}" for file in judged.files if file.suffix in (".png", ".json")), *(f"  {note}" for note in judged.notes)])
