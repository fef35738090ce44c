"""Error bars from lattice refinement: the same garment draped on a coarser lattice.

With an error that grows as the spacing h (order 1, which the strip at the contour has; the lattice inside is better) two spacings give the value at h -> 0 and

    error of the finer one = |q_fine - q_coarse| / (r - 1),    r = h_coarse / h_fine.

Of several coarser lattices the largest bar counts. Where folds fall differently on two lattices that difference is in the bar: it is an estimate of what the
figure can be trusted for, no bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from garmentcad.analysis.figures import Figure
from garmentcad.errors import InputError


def error_bars(fine: Mapping[str, Figure], grid_mm: float, coarser: Sequence[tuple[float, Mapping[str, Figure]]]) -> dict[str, float]:
    """Error bar of each figure that some coarser lattice has, too. coarser: spacing in mm and figures. InputError for a lattice that is not coarser."""
    bars: dict[str, float] = {}
    for coarse_mm, coarse in coarser:
        if not coarse_mm > grid_mm:
            raise InputError(f"a lattice of {coarse_mm:g} mm came; it must be coarser than the {grid_mm:g} mm of the garment", key="coarser")
        for path, figure in fine.items():
            other = coarse.get(path)
            if figure.value is not None and other is not None and other.value is not None:
                bars[path] = max(bars.get(path, 0.0), abs(figure.value - other.value) / (coarse_mm / grid_mm - 1.0))
    return bars
