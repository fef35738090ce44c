"""Other values of a garment's parameters: in Python and on the command line."""

from __future__ import annotations

import pytest

from garmentcad.check.examine import examine
from garmentcad.cli.named import named_numbers
from garmentcad.errors import InputError, SpecError
from garmentcad.pattern.draft import draft
from garmentcad.simulation.job import make_job


def test_a_value_changes_the_draft_and_what_a_checkpoint_agrees_with() -> None:
    short, long = make_job("straight-skirt"), make_job("straight-skirt", values={"length": 700.0})
    drafted = draft(short.spec, short.mannequin.measurements_mm, {"length": 700.0})  # type: ignore[arg-type]
    lowest = [min(edge.curve.polyline(1.0)[:, 1].min() for edge in pattern.panels["front"].edges) for pattern in (short.pattern, long.pattern, drafted)]
    assert lowest[0] - lowest[1] == pytest.approx(700.0 - short.pattern.values["length"])
    assert lowest[1] == lowest[2]
    assert short.identity["spec"] != long.identity["spec"]


def test_a_name_that_is_no_parameter_and_a_value_out_of_range_are_refused() -> None:
    with pytest.raises(SpecError, match="no parameter is called 'lenght'; did you mean 'length'"):
        make_job("straight-skirt", values={"lenght": 700.0})
    (finding,) = examine("straight-skirt", values={"length": 7000.0})
    assert (finding.severity, finding.key) == ("error", "parameters.length.value")
    with pytest.raises(InputError, match="for each garment"):
        make_job("tucked-in", values={"length": 700.0})


@pytest.mark.parametrize(
    ("words", "message"), [(["a"], "NAME=NUMBER"), (["a=x"], "NAME=NUMBER"), (["a=nan"], "NAME=NUMBER"), (["a=1", "a=2"], "twice"), (["=2"], "NAME")]
)
def test_words_that_are_no_named_numbers(words: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        named_numbers(words, "--set")
    assert named_numbers(["a=1", "b=-2.5"], "--set") == {"a": 1.0, "b": -2.5}
