"""What an element of the lattice adds to row sums arrives at its own corners and neighbours, once each. That they bound the tangent: test_force_internal.py."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.forces import lattice_bound
from garmentcad.forces.lattice_bound import _sum_bounds

UP, ROWS = 9, 11
AT = 5 * UP + 4
# (column, row) of those that get it, from the slot of the element
PLACES = {
    "_WEFT": [(0, 0), (1, 0)],
    "_WARP": [(0, 0), (0, 1)],
    "_EVEN": [(0, 0), (1, 1)],
    "_ODD": [(1, 0), (0, 1)],
    "_BESIDE": [(0, -1), (1, -1), (-1, 0), (2, 0), (-1, 1), (2, 1), (0, 2), (1, 2)],
    "_WEFT_LINE": [(0, 0)],
    "_WARP_LINE": [(0, 0)],
}
BEFORE_AND_BEHIND = {"_WEFT_LINE": [(-1, 0), (1, 0)], "_WARP_LINE": [(0, -1), (0, 1)]}


def landed(row: int) -> set[tuple[int, int]]:
    room, out = np.zeros((18, UP * ROWS)), np.zeros(UP * (ROWS - 5))
    room[row, AT] = 1.0
    first = 3 * UP
    _sum_bounds(first, first + len(out), np.int64(UP), room, out)
    assert set(out) <= {0.0, 1.0}
    return {(int(slot % UP) - AT % UP, int(slot // UP) - AT // UP) for slot in first + np.flatnonzero(out)}


@pytest.mark.parametrize("name", PLACES)
def test_bounds_arrive_where_their_elements_act(name: str) -> None:
    row = getattr(lattice_bound, name)
    assert landed(row) == set(PLACES[name])
    for k, place in enumerate(BEFORE_AND_BEHIND.get(name, [])):
        assert landed(row + 1 + k) == {place}
