"""Internal friction of a fabric: a stick spring in series with a slider, beside the elastic curve. One element for tension, shear and bending.

    stress = elastic(e) + k(e) (e - s),      s <- min(max(s, e - d), e + d)

e is the strain of the curve, s the slider, a strain too, k the stiffness of the stick spring and d its way; k d = H, half the width of the tester's loop.
As long as |e - s| < d the slider keeps its bits: the friction is then a spring, exactly, and nothing creeps. Beyond it is +H or -H, and the slider follows;
with d = 0 it follows always and there is no friction. Moving a slider twice for one strain is moving it once, so that it does not matter how often a strain is
looked at, or by whom.

Stored in the stick spring: the integral of k(e') (e' - s) from s to e. A slider that moves by m loses the mean of H between s and e times |m|.
Source: Jenkins element (Coulomb slider and spring in series); Kawabata 1980 for the loops.
"""

from __future__ import annotations

from garmentcad.arrays import kernel


@kernel
def dragged(slider: float, strain: float, way: float) -> float:
    """Where a strain leaves its slider. way: d, in the same unit."""
    return min(max(slider, strain - way), strain + way)
