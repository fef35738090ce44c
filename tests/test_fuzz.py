"""500 garments with their fabric and 500 body scans with seeded faults: a result or a GarmentError, in memory below 1 GiB, and no hang.

tools/fuzz_study.py does the same for 20,000 and 5,000.
"""

from __future__ import annotations

import pytest

from tools.fuzz_study import run_cases


@pytest.mark.parametrize(("kind", "count"), [("garment", 500), ("scan", 500)])
def test_faults_are_refused_and_nothing_else_happens(kind: str, count: int) -> None:
    outcome = run_cases(kind, 0, count)
    assert outcome.faults == {}
    good = sum(count for end, count in outcome.ends.items() if not end.endswith("Error"))
    assert 0.1 * count < good < 0.9 * count, outcome.ends  # neither all nor none: the faults reach what they shall reach
    assert len(outcome.ends) >= 3


@pytest.mark.parametrize("seed", [8555, 12422])
def test_what_was_no_refusal_once_is_one_now(seed: int) -> None:
    """Pleats whose folds leave the panel at once; a wrap whose offset goes through its axis."""
    outcome = run_cases("garment", seed, 1)
    assert (outcome.faults, dict(outcome.ends)) == ({}, {"SpecError": 1})
