"""What stands in for the values that a sheet lacks, and whether the sheet agrees with itself. docs/fabric.md lists the same rules in words.

Each rule needs other values of the sheet and gives one; the first rule whose needs are met is used, and a finding says what was assumed from what.
Nothing stands in for W. Values that no law reads (Tm, MMD, SMD, LC, WC, RC and unprinted means) stay blank.
Numbers of the rules: 0.97, 0.64 and 0.14 from the percentiles of 618 fabrics (Feng et al. 2022); 0.9 is about the median of 2HB/B (0.88) over ten
measured fabrics (four of Matsudaira et al. 2015, six denims of Kumari and Khurana 2016), 1.66 the median of 2HG5/2HG over those denims; 2 degrees
for 2HG/G lies between those denims (median 2.3) and the middle of suitings (G 0.5 to 0.65, 2HG5 0.8 to 2.6: 1.8); the other defaults lie inside the
ranges of measured suitings and denims. `tools/rule_study.py` holds every rule against what was measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from garmentcad.errors import FabricError
from garmentcad.fabric.finding import Finding, Severity
from garmentcad.fabric.law_shear import LEAST_ELASTIC, elastic_slope
from garmentcad.fabric.law_tension import least_resilience, solve_exponent
from garmentcad.fabric.quantity import QUANTITIES, quantity_of
from garmentcad.fabric.sheet import KesSheet, KesValue, is_calibrated

USUAL_FM = 500.0  # gf/cm, to which the tester pulls where a sheet names no Fm
USUAL_2HB = 0.9  # 1/cm, 2HB over B where 2HB is not given
SELF_CHECK = 0.03  # WT against LT Fm EMT/200
_APART = 0.05  # a mean against that of warp and weft


class Rule(NamedTuple):
    """`key` = formula(values under `needs`), in words `text`. severity `warning`: a value that nothing of its kind was measured for."""

    key: str
    needs: tuple[str, ...]
    formula: Callable[..., float]
    text: str
    severity: Severity


class Completed(NamedTuple):
    """A sheet without gaps in what the laws read, everything that was noticed on the way, and the keys that a rule filled."""

    sheet: KesSheet
    findings: tuple[Finding, ...]
    assumed: frozenset[str]


_Directed = Callable[[str, str], Rule]  # from a direction and its other


def _same(value: float) -> float:
    return value


def _by_way(*rules: _Directed) -> Iterator[Rule]:
    """Each rule for warp and weft before the next one, so that a poorer rule for warp never hides a better one for weft."""
    for rule in rules:
        yield rule("warp", "weft")
        yield rule("weft", "warp")


def _means(name: str) -> tuple[_Directed, ...]:
    return (
        lambda way, other: Rule(f"{name}.{way}", (f"{name}.mean", f"{name}.{other}"), lambda mean, known: 2.0 * mean - known, f"2 mean - {other}", "info"),
        lambda way, other: Rule(f"{name}.{way}", (f"{name}.mean",), _same, "equal to the mean of warp and weft", "info"),
    )


def _other(name: str, severity: Severity = "info") -> _Directed:
    return lambda way, other: Rule(f"{name}.{way}", (f"{name}.{other}",), _same, f"equal to {other}", severity)


def _default(name: str, number: float, text: str, severity: Severity) -> _Directed:
    return lambda way, other: Rule(f"{name}.{way}", (), lambda: number, text, severity)


def _from(name: str, of: str, formula: Callable[..., float], text: str, severity: Severity) -> _Directed:
    """From other values; WAY and OTHER in their keys stand for the directions."""

    def rule(way: str, other: str) -> Rule:
        needs = tuple(need.replace("WAY", way).replace("OTHER", other) for need in of.split())
        return Rule(f"{name}.{way}", needs, formula, text.replace("OTHER", other), severity)

    return rule


def _rules() -> Iterator[Rule]:
    yield Rule("Fm", (), lambda: USUAL_FM, "500 gf/cm, the tester's standard", "info")

    def from_energy(wt: float, known: float, fm: float) -> float:
        return 200.0 * wt / (fm * known)

    yield from _by_way(
        _from("LT", "WT.WAY EMT.WAY Fm", from_energy, "200 WT/(Fm EMT)", "info"),
        *_means("LT"),
        _from("LT", "WT.mean EMT.mean Fm", from_energy, "200 WT/(Fm EMT) of the means", "info"),
        _from("LT", "WT.WAY WT.OTHER EMT.mean Fm", lambda wt, other, emt, fm: 100.0 * (wt + other) / (fm * emt), "200 mean WT/(Fm EMT.mean)", "info"),
        _other("LT"),
        _default("LT", 0.65, "0.65, between suitings (0.5 to 0.6) and denims (0.65 to 0.78)", "info"),
        _from("EMT", "WT.WAY LT.WAY Fm", from_energy, "200 WT/(LT Fm)", "info"),
        *_means("EMT"),
        _from("EMT", "WT.mean LT.WAY Fm", from_energy, "200 WT/(LT Fm) with the mean WT", "info"),
        _other("EMT", "warning"),
        _default("EMT", 5.0, "5 %, usual for a firm woven fabric", "warning"),
        _from("WT", "LT.WAY Fm EMT.WAY", lambda lt, fm, emt: lt * fm * emt / 200.0, "LT Fm EMT/200", "info"),
        *_means("RT"),
        _other("RT"),
        _default("RT", 60.0, "60 %, usual for suitings and denims", "info"),
        *_means("G"),
        _other("G"),
        _from("G", "W", lambda w: 0.03 * w, "0.03 W (0.6 for a suiting of 200 g/m2)", "warning"),
        *_means("2HG"),
        _from("2HG", "2HG5.WAY", lambda hg5: hg5 / 1.66, "2HG5/1.66", "info"),
        _other("2HG"),
        _from("2HG", "2HG5.mean", lambda hg5: hg5 / 1.66, "2HG5/1.66 of the mean", "info"),
        _from("2HG", "G.WAY", lambda g: 2.0 * g, "2 degrees x G", "warning"),
        *_means("2HG5"),
        _other("2HG5"),
        _from("2HG5", "2HG.WAY", lambda hg: 1.66 * hg, "1.66 x 2HG", "info"),
        *_means("B"),
    )
    yield Rule("B.warp", ("B.weft",), lambda weft: weft / 0.64, "B.weft/0.64", "warning")
    yield Rule("B.warp", ("W",), lambda w: 0.14 * (w / 19.7) ** 1.7, "0.14 (W/19.7)^1.7, through the medians of 618 fabrics", "warning")
    yield Rule("B.weft", ("B.warp",), lambda warp: 0.64 * warp, "0.64 B.warp", "warning")
    yield Rule("B.bias", ("B.warp", "B.weft"), lambda warp, weft: 0.97 * math.sqrt(warp * weft), "0.97 sqrt(B.warp B.weft)", "info")
    yield from _by_way(
        *_means("2HB"),
        _from("2HB", "2HB.OTHER B.WAY B.OTHER", lambda hb, b, known: hb * b / known, "2HB.OTHER in the ratio of B", "info"),
        _from("2HB", "B.WAY", lambda b: USUAL_2HB * b, f"{USUAL_2HB:g} /cm x B", "warning"),
    )
    yield Rule("2HB.bias", ("2HB.warp", "2HB.weft"), lambda warp, weft: math.sqrt(warp * weft), "sqrt(2HB.warp 2HB.weft)", "info")
    yield Rule("T0", ("W",), lambda w: w / 40.0, "W/40, a fabric density of 0.4 g/cm3", "info")
    yield Rule("MIU.mean", ("MIU.warp", "MIU.weft"), lambda warp, weft: 0.5 * (warp + weft), "mean of warp and weft", "info")
    yield Rule("MIU.mean", ("MIU.warp",), _same, "equal to warp", "info")
    yield Rule("MIU.mean", ("MIU.weft",), _same, "equal to weft", "info")
    yield Rule("MIU.mean", (), lambda: 0.2, "0.2, usual for woven fabrics", "warning")


RULES: tuple[Rule, ...] = tuple(_rules())
FILLED: tuple[str, ...] = tuple(dict.fromkeys(["W", *(rule.key for rule in RULES)]))


def complete(sheet: KesSheet) -> Completed:
    """Check a sheet against itself and fill its gaps by the rules. FabricError where W is missing, a rule gives an impossible number, or WT contradicts
    LT, Fm and EMT by more than 3 %."""
    findings = noticed(sheet)
    if sheet.W is None:
        raise FabricError("the mass per area is missing; nothing can stand in for it (1 mg/cm2 is 10 g/m2)", key="W")
    numbers = {key: value.value for key, value in sheet.values().items()}
    filled: dict[str, KesValue] = {}
    for rule in RULES:
        if rule.key in numbers or not all(need in numbers for need in rule.needs):
            continue
        number = rule.formula(*(numbers[need] for need in rule.needs))
        quantity = quantity_of(rule.key)
        low, high = quantity.possible
        if not low <= number <= high:
            given = ", ".join(f"{need} = {numbers[need]:g}" for need in rule.needs)
            raise FabricError(f"missing, and the rule {rule.text} with {given} gives {number:.4g}, outside {low:g} to {high:g} {quantity.unit}", key=rule.key)
        numbers[rule.key] = number
        filled[rule.key] = KesValue(value=number, estimate=rule.text)
        unit = "" if quantity.unit == "-" else f" {quantity.unit}"
        findings.append(Finding(rule.severity, rule.key, f"missing; taken as {number:.4g}{unit}: {rule.text}"))
    findings += _disagreements(numbers, filled)
    findings += beyond_laws(numbers, sheet.shear_window_deg)
    done = sheet.with_values(filled).model_copy(update={"law": sheet.law})  # a law belongs to the numbers of the completed sheet
    if done.law is not None and not is_calibrated(done):
        findings.append(Finding("warning", "law", "the calibrated law belongs to other numbers of this sheet and is not used; calibrate again"))
    return Completed(done, tuple(findings), frozenset(filled))


def _disagreements(numbers: Mapping[str, float], filled: Mapping[str, KesValue]) -> Iterator[Finding]:
    """Where what was filled does not agree with what was given."""
    for name in dict.fromkeys(key.partition(".")[0] for key in filled if key.endswith((".warp", ".weft"))):  # given ones are held against their mean as given
        yield from _off_mean(numbers, name, ", which follow from other values")


def beyond_laws(numbers: Mapping[str, float], window_deg: tuple[float, float]) -> Iterator[Finding]:
    """Values of a complete sheet, by key, that the laws cannot have together, and what they have instead."""
    slope, narrow, wide = (0.5 * (numbers[f"{name}.warp"] + numbers[f"{name}.weft"]) for name in ("G", "2HG", "2HG5"))
    if elastic_slope(slope, narrow, wide, window_deg) <= LEAST_ELASTIC * slope:
        yield Finding("warning", "2HG5", f"with 2HG = {narrow:g} and 2HG5 = {wide:g} friction rises about as fast as G = {slope:g}; G/10 is left")
    for way in ("warp", "weft"):
        least = least_by_law(f"RT.{way}", numbers)
        if numbers[f"RT.{way}"] < least:
            yield Finding("warning", f"RT.{way}", f"with LT = {numbers[f'LT.{way}']:g} the law gives back {least:.0f} % at least; it prints that")
    least = least_by_law("B.bias", numbers)
    if numbers["B.bias"] < least:
        text = f"with B = {numbers['B.warp']:g} in warp and {numbers['B.weft']:g} in weft the law has {least:.4g} in the bias at least; it prints that"
        yield Finding("warning", "B.bias", text)


def least_by_law(key: str, numbers: Mapping[str, float]) -> float:
    """Below which no law prints the value `key`, whatever the sheet says: RT beside its LT, B of the bias beside those of warp and weft; 0 of any other."""
    name, _, way = key.partition(".")
    if name == "RT":
        return 100.0 * least_resilience(solve_exponent(numbers[f"LT.{way}"]))
    return 0.25 * (numbers["B.warp"] + numbers["B.weft"]) if key == "B.bias" else 0.0


def noticed(sheet: KesSheet) -> list[Finding]:
    """What is unusual in the values that a sheet has, gaps or not. FabricError where WT contradicts LT, Fm and EMT by more than 3 %."""
    return [*_unusual(sheet), *_contradictions(sheet)]


def measured_fraction(sheet: KesSheet) -> float:
    """Share of the values that the laws need, or will need, that this sheet holds as measurements (0 to 1).

    A measured mean counts for warp and weft; measured warp and weft count for the mean.
    """
    measured = {key for key, value in sheet.values().items() if value.estimate is None}
    count = 0
    for key in FILLED:
        name, _, way = key.partition(".")
        if way == "mean":
            count += key in measured or {f"{name}.warp", f"{name}.weft"} <= measured
        else:
            count += key in measured or (way in ("warp", "weft") and f"{name}.mean" in measured)
    return count / len(FILLED)


def _unusual(sheet: KesSheet) -> Iterator[Finding]:
    for key, value in sheet.values().items():
        quantity = quantity_of(key)
        low, high = quantity.usual
        if not low <= value.value <= high:
            slip = f"; {quantity.slip}" if quantity.slip else ""
            yield Finding("warning", key, f"{value.value:g} {quantity.unit} is outside the usual {low:g} to {high:g}{slip}")


def _off_mean(numbers: Mapping[str, float], name: str, tail: str) -> Iterator[Finding]:
    """A printed mean that is not that of warp and weft. tail: of the message."""
    warp, weft, mean = (numbers.get(f"{name}.{way}") for way in ("warp", "weft", "mean"))
    if warp is not None and weft is not None and mean is not None and abs(mean - (warp + weft) / 2) > _APART * mean:
        yield Finding("warning", f"{name}.mean", f"{mean:g} is not the mean of warp {warp:.4g} and weft {weft:.4g}{tail}")


def _contradictions(sheet: KesSheet) -> Iterator[Finding]:
    numbers = {key: value.value for key, value in sheet.values().items()}
    fm = numbers.get("Fm", USUAL_FM)
    for way in ("warp", "weft", "mean"):
        wt, lt, emt = (numbers.get(f"{name}.{way}") for name in ("WT", "LT", "EMT"))
        if wt is None or lt is None or emt is None:
            continue
        expected = lt * fm * emt / 200.0
        off = wt / expected - 1.0
        if abs(off) > SELF_CHECK:
            message = f"WT = {wt:g} is {100 * off:+.1f} % off LT Fm EMT/200 = {lt:g} x {fm:g} x {emt:g}/200 = {expected:.4g} gf.cm/cm2; at most 3 % is allowed"
            if way != "mean":  # the product of means need not be the mean of products
                raise FabricError(f"{message}: one of the four is wrong, or leave WT out", key=f"WT.{way}")
            yield Finding("warning", "WT.mean", message)
    for quantity in QUANTITIES.values():
        yield from _off_mean(numbers, quantity.name, "; warp and weft are used")
    for small, large in (("2HG", "2HG5"), ("Tm", "T0")):
        for way in ("", ".warp", ".weft", ".mean"):
            a, b = numbers.get(small + way), numbers.get(large + way)
            if a is not None and b is not None and a > b:
                yield Finding("warning", small + way, f"{a:g} is larger than {large} = {b:g}; it is the other way round on real cloth")
