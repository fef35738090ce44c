"""A small loose piece lies in drape mode where true motion lays it: friction holds it in the ridges in which it came down."""

from __future__ import annotations

import pytest

from garmentcad.bench.cloth_on_ball import cloth_on_ball
from garmentcad.simulation.lattices import grids_of, is_small
from tools.agreement_study import MOST_PIECE_MM, PIECES, apart_mm, both_modes, piece


def test_a_swatch_on_a_ball_lies_alike_in_both_modes() -> None:
    """3.4 mm apart, and 16 mm where it is worst, when it fell with soft tension."""
    drape, dynamics = both_modes(piece(PIECES[0], "drape"))
    assert (drape.status, dynamics.status) == ("converged", "converged")
    apart = apart_mm(drape.cloth.masses, drape.state.positions, dynamics.state.positions)
    assert apart["rms_mm"] < MOST_PIECE_MM
    assert apart["most_mm"] < 2.0 * MOST_PIECE_MM
    assert drape.state.time_s < 0.8 * dynamics.state.time_s, "what comes after the fall is drape mode's"


@pytest.mark.parametrize(("grid_mm", "small", "grids"), [(10.0, False, (20.0, 10.0)), (20.0, False, (20.0,)), (40.0, True, (40.0,))])
def test_small_is_what_no_coarser_lattice_would_hold_the_folds_of(grid_mm: float, small: bool, grids: tuple[float, ...]) -> None:
    job = cloth_on_ball(grid_mm)
    assert is_small(job) == small
    assert grids_of(job) == grids
