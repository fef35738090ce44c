"""The tension loop of KES-FB1 to LT, WT, RT, EMT: the definitions of the tester, on the record.

    EMT = strain at Fm      WT = area under the way out      LT = WT/(Fm EMT/2)      RT = area under the way back/WT

The first sample is the zero of strain; the force there (a parabola through the first tenth of the way out) is the zero of force; a parabola through
the last tenth gives force and slope at the end.
Fm is 50, 100 or 500 gf/cm where the record ends within 3 % of it, else what the record says; a loop that ends a little off is brought to Fm along its tangent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from garmentcad.errors import FabricError
from garmentcad.fabric.finding import Finding
from garmentcad.fabric.fitted import FittedValue
from garmentcad.fabric.law_tension import solve_exponent
from garmentcad.fabric.recorded_loop import RecordedLoop, cut_legs, noise_of, spread_by_noise

NOMINAL_GF_CM = (50.0, 100.0, 500.0)
NEAR = 0.03  # share of Fm within which a record counts as one to the nominal force
START = 0.1  # shares of the way out on which the zero of force and the end are read, by parabolas
END = 0.1
LEAST = 5  # samples of such a parabola
MOST_OFFSET = 0.1  # share of Fm
# Shares of Fm and of the way out from which a zero that was taken off, or a force that does not begin to grow, is worth knowing.
TOLD_OFFSET, BEGUN, TOLD_SLACK = 0.01, 0.005, 0.03
RESOLVED = 1e-3  # share of a value that a record resolves at best
STEPS = 25.0  # of the trapezoid rule on a steep exponential: share of an area times the square of the number of samples


def fit_tension(loops: Sequence[RecordedLoop]) -> list[FittedValue]:
    """Values of the tension loops of one fabric. FabricError for what is no loop, and for loops that end at different forces."""
    if not loops:
        return []
    tops = [_end(loop)["top"] for loop in loops]
    if max(tops) - min(tops) > NEAR * max(tops):
        raise FabricError(f"the loops end at {', '.join(f'{top:.4g}' for top in tops)} gf/cm; Fm belongs to the whole sheet, within 3 %", key="Fm")
    mean = float(np.mean(tops))
    force = next((nominal for nominal in NOMINAL_GF_CM if abs(mean - nominal) <= NEAR * nominal), mean)
    fitted = [FittedValue("Fm", force, min(force, *tops), max(force, *tops), "where the tension loops end", tuple(loop.key for loop in loops))]
    for loop in loops:

        def values(record: RecordedLoop) -> dict[str, float]:
            return _values(record, force)

        found, spread = values(loop), spread_by_noise(loop, values)
        for name, value in found.items():
            half = spread[name] + (RESOLVED + STEPS / len(loop.x) ** 2) * abs(value) + (_unseen_of_turn(loop) + _unseen_of_end(loop) if name == "RT" else 0.0)
            how = f"tension loop of {len(loop.x)} samples"
            fitted.append(FittedValue(f"{name}.{loop.way}", value, value - half, value + half, how, (loop.key,)))
    return fitted


def doubtful_starts(loops: Sequence[RecordedLoop]) -> list[Finding]:
    """Findings on tension loops that may begin with a specimen that was pulled already, or hung slack: `fit_tension` cannot tell that from an amplifier whose
    zero is off, or from cloth that gives way easily."""
    found = []
    for loop in loops:
        out, end = cut_legs(loop)[0], _end(loop)
        place, top = f"{loop.file}: {loop.place}", end["top"]
        if abs(end["zero"]) > TOLD_OFFSET * top:
            why = f"the record begins at {end['zero']:.3g} gf/cm, which was taken off all of it as the zero of the amplifier"
            found.append(Finding("warning", place, f"{why}; where the specimen was pulled so at the start Fm, LT and RT are wrong"))
        least = max(BEGUN, 4.0 * noise_of(loop.y, loop.x) / top)
        exponent = solve_exponent(float(np.clip(_values(loop, top)["LT"], 0.05, 1.95)))
        strain, wanted = (out.x - end["start"]) / end["strain"], np.log1p(least * np.expm1(exponent)) / exponent if exponent else least
        begun = float(strain[np.argmax(out.y - end["zero"] > least * top)])
        if begun > wanted + TOLD_SLACK:
            why = f"the force grows from {begun * end['strain']:.3g} % of strain on, where a curve of this LT does so from {wanted * end['strain']:.3g} %"
            found.append(Finding("warning", place, f"{why}; where the specimen hung slack EMT is too large and LT too small: leave these samples out"))
    return found


def _unseen_of_turn(loop: RecordedLoop) -> float:
    """Points of RT by which the trapezoid at the turn may be off: where the force falls faster in the first step back than in the next, nobody saw when."""
    out, back = cut_legs(loop)[:2]
    way, fall = np.abs(np.diff(back.x[:4])), np.abs(np.diff(back.y[:4]))
    if len(fall) < 3:
        return 0.0
    first, second, third = fall / np.maximum(way, 1e-12)
    sudden = way[0] * max(0.0, first - 2.0 * second + third)
    return float(50.0 * way[0] * sudden / np.trapezoid(out.y, out.x))


def _unseen_of_end(loop: RecordedLoop) -> float:
    """Points of RT that a way back which stops above the zero of force may lack: the triangle from there down to the zero of strain. Curves are hollow."""
    out, back = cut_legs(loop)[:2]
    end = _end(loop)
    rest = max(0.0, float(back.y[-4:].mean()) - end["zero"])
    return float(50.0 * rest * max(0.0, float(back.x[-1]) - end["start"]) / np.trapezoid(out.y - end["zero"], out.x))


def _end(loop: RecordedLoop) -> dict[str, float]:
    """Zero of strain and force, force and slope at the end of the way out."""
    out = cut_legs(loop)[0]
    if out.direction < 0.0:
        raise loop.refuse("the strain falls first")
    if len(loop.turns) > 3:
        growing = loop.turns[2] + int(np.argmax(loop.x[loop.turns[2] :] > loop.x[loop.turns[2]]))
        raise loop.refuse(f"at sample {growing} the strain grows again; one loop in a column is allowed")
    start, top = out.x[0], out.x.max()
    first = out.x <= start + START * (top - start)
    if first.sum() < LEAST:
        first = np.arange(len(out.x)) < LEAST
    zero = float(np.polynomial.polynomial.polyfit(out.x[first] - start, out.y[first], 2)[0])
    last = out.x >= top - END * (top - start)
    if last.sum() < LEAST:
        last = np.arange(len(out.x)) >= len(out.x) - LEAST
    force, slope, _ = np.polynomial.polynomial.polyfit(out.x[last] - top, out.y[last], 2)
    if force <= zero or slope <= 0.0:
        raise loop.refuse("the force does not grow with the strain")
    if abs(zero) > MOST_OFFSET * (force - zero):
        raise loop.refuse(f"the record begins at {zero:.3g} gf/cm, more than a tenth of its end")
    return {"start": float(start), "zero": zero, "top": float(force - zero), "slope": float(slope), "strain": float(top - start)}


def _values(loop: RecordedLoop, force: float) -> dict[str, float]:
    out, back = cut_legs(loop)[:2]
    end = _end(loop)
    taken = float(np.trapezoid(out.y - end["zero"], out.x))
    given = -float(np.trapezoid(back.y - end["zero"], back.x))
    rest = back.y[-4:].mean() - end["zero"]
    if rest > MOST_OFFSET * end["top"]:
        raise loop.refuse(f"the way back ends at {rest:.4g} gf/cm, above a tenth of {end['top']:.4g}")
    if not 0.0 < given <= 1.02 * taken:
        raise loop.refuse(f"the way back gives {given / 100.0:.4g} of the {taken / 100.0:.4g} gf.cm/cm2 that the way out took")
    more = (force - end["top"]) / end["slope"]
    emt = end["strain"] + more
    wt = (taken + more * 0.5 * (force + end["top"])) / 100.0
    return {"LT": wt / (force * emt / 200.0), "WT": wt, "RT": 100.0 * given / taken, "EMT": emt}
