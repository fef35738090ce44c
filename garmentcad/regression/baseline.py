"""Baselines: what a garment's figures are over several lays, and how far they may go before a test fails.

Value and tolerance of a figure: mean of n lays, and k standard deviations, k such that the mean of m more lays of normally distributed figures lies within
with a probability of 99.98 %: k = t sqrt(1/m + 1/n), t the two-sided quantile of Student's distribution with n - 1 degrees of freedom (a prediction interval;
6.3 for ten lays and one more). Never less than 1 for counts and a thousandth of the value for others: lays that agree by chance are no proof of more. Distances
from the baseline's shape, of which only large ones are bad, may reach the mean plus k standard deviations (m = 1) of those of the other lays.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field
from scipy.special import stdtrit  # of scipy.stats, which takes half a second to import

from garmentcad.errors import FileError, SpecError
from garmentcad.io.atomic import write_atomic
from garmentcad.io.json_file import read_json
from garmentcad.io.npz_file import read_npz
from garmentcad.pattern.garment_test import ANY, SHAPE, Number, ReportKey, Tolerance
from garmentcad.pattern.model import Model
from garmentcad.pattern.parse import parse_model
from garmentcad.schema_version import SchemaVersion

CONFIDENCE = 0.9998
_REMEDY = "make it anew with `garmentcad test --remake`"
LEAST_COUNT, LEAST_SHARE = 1.0, 1e-3
# So many that k (10.5) is less than three times what any number of lays would make it (3.7). Five have 14, four 25, three 82: that holds for anything.
FEWEST_LAYS = 6


RULE = (
    f"mean of n lays +- k sd; k = t sqrt(1/m + 1/n), m lays in a test, Student's t for {100 * CONFIDENCE:g} % on both sides; "
    f"at least {LEAST_COUNT:g} for counts, {LEAST_SHARE:g} of the value for others; distances from the shape: at most mean + k sd"
)


class Figure(Model):
    """A number over the lays: mean, tolerance, standard deviation, least and greatest."""

    value: Number
    tol: Annotated[Number, Field(ge=0)]
    sd: Annotated[Number, Field(ge=0)]
    low: Number
    high: Number

    @property
    def expected(self) -> Tolerance:
        return Tolerance(value=self.value, tol=self.tol)


class Baseline(Model):
    """Figures by report key, and what they were made of. refused: starts that were no lays because panels crossed. A baseline holds for its setting (garment,
    fabric, mannequin, grid) and for the keys that the test names.

    rms_mm, max_mm: distances of the other lays from the shape of the first, where the test asks for the shape.
    """

    schema_version: SchemaVersion = Field(default=1, alias="schema")
    version: str
    rule: str
    lays: Annotated[int, Field(strict=True, ge=FEWEST_LAYS)]
    refused: Annotated[int, Field(strict=True, ge=0)]
    setting: dict[str, str]
    keys: list[ReportKey]
    report: dict[str, Figure]  # `*` in a key may stand for long names
    rms_mm: Figure | None = None
    max_mm: Figure | None = None

    def distances(self) -> dict[str, Figure]:
        """Those of rms_mm and max_mm that the baseline has."""
        return {name: figure for name, figure in (("rms_mm", self.rms_mm), ("max_mm", self.max_mm)) if figure is not None}


class Shape:
    """The surface of a draped garment, as far as it takes to compare and draw it. positions: (P,3) m."""

    def __init__(self, positions: np.ndarray, triangles: np.ndarray, vertex_particle: np.ndarray) -> None:
        self.positions, self.triangles, self.vertex_particle = positions, triangles, vertex_particle

    @property
    def particle_triangles(self) -> np.ndarray:
        """(F,3) triangles in particle indices."""
        return self.vertex_particle[self.triangles]

    @property
    def triangle_layer(self) -> np.ndarray:
        """(F,) zeros: it is only drawn under a map."""
        return np.zeros(len(self.triangles), dtype=np.int32)


def factor(lays: int, more: int = 1, confidence: float = CONFIDENCE) -> float:
    """Standard deviations within which the mean of that many more lays lies with that probability."""
    return float(stdtrit(lays - 1, 0.5 * (1.0 + confidence))) * math.sqrt(1.0 / more + 1.0 / lays)


def figure(values: Sequence[float | int], more: int = 1) -> Figure:
    """Mean, tolerance and spread of a value over lays. more: lays whose mean a test compares with it."""
    mean, sd = float(np.mean(values)), float(np.std(values, ddof=1))
    least = LEAST_COUNT if all(isinstance(value, int) for value in values) else LEAST_SHARE * abs(mean)
    return _figure(mean, max(factor(len(values), more) * sd, least), sd, values)


def distance_figure(values: Sequence[float]) -> Figure:
    """The same of a distance in mm from the shape of another lay: tol is how much more than the mean it may be."""
    mean, sd = float(np.mean(values)), float(np.std(values, ddof=1))
    return _figure(mean, factor(len(values)) * sd, sd, values)


def _figure(mean: float, tol: float, sd: float, values: Sequence[float | int]) -> Figure:
    low, high = (float(f"{end(values):.6g}") for end in (min, max))
    return Figure(value=float(f"{mean:.6g}"), tol=float(f"{tol:.3g}"), sd=float(f"{sd:.3g}"), low=low, high=high)


def write_baseline(path: Path, baseline: Baseline, shape: Shape) -> tuple[Path, Path]:
    """Write NAME.baseline.json, and the shape beside it as NAME.baseline.npz (single precision: 0.1 um at a metre); the picture of a failed test needs it."""
    text = json.dumps(baseline.model_dump(mode="json", by_alias=True, exclude_none=True), indent=1)
    beside = path.with_suffix(".npz")
    arrays = {
        "positions": shape.positions.astype(np.float32),
        "triangles": shape.triangles.astype(np.int32),
        "vertex_particle": shape.vertex_particle.astype(np.int32),
    }
    write_atomic(beside, lambda file: np.savez_compressed(file, **arrays))  # type: ignore[arg-type]
    return write_atomic(path, f"{text}\n"), beside


def read_baseline(path: Path, setting: dict[str, str], keys: Sequence[str]) -> Baseline:
    """Read what `write_baseline` wrote. FileError or SpecError for a file that is missing, torn, was made for another setting or
    for other keys, or lacks the figures of a key: a key without one would pass unseen."""
    if not path.exists():
        raise FileError(f"there is no baseline yet; {_REMEDY}", file=str(path))
    baseline = parse_model(Baseline, read_json(path), str(path))
    here = setting | {"keys": " ".join(sorted(keys))}
    there = baseline.setting | {"keys": " ".join(sorted(baseline.keys))}
    unlike = [f"{name}: {there.get(name)!r} there, {here.get(name)!r} here" for name in sorted({*here, *there}) if there.get(name) != here.get(name)]
    if unlike:
        raise SpecError(f"the baseline belongs to another test ({', '.join(unlike)}); {_REMEDY}", file=str(path))
    bare = [key for key in keys if not _has_figure(baseline, key)]
    if bare:
        raise SpecError(f"there is no figure of {', '.join(bare)}; {_REMEDY}", file=str(path), key="report")
    return baseline


def _has_figure(baseline: Baseline, key: str) -> bool:
    if key == SHAPE:
        return baseline.distances().keys() == {"rms_mm", "max_mm"}
    meant = re.compile(".+".join(re.escape(part) for part in key.split(ANY)))
    return any(meant.fullmatch(path) for path in baseline.report)


def read_shape(path: Path) -> Shape:
    """The shape beside a baseline. FileError where it is missing, torn, or no surface."""
    beside = path.with_suffix(".npz")
    if not beside.exists():
        raise FileError(f"the shape that belongs to {path.name} is missing; take it back from where both are kept, or {_REMEDY}", file=str(beside))
    arrays = read_npz(beside)
    try:
        positions, triangles, owner = (arrays[name] for name in ("positions", "triangles", "vertex_particle"))
        shape = Shape(np.asarray(positions, dtype=np.float64), np.asarray(triangles, dtype=np.int32), np.asarray(owner, dtype=np.int32))
        whole = (
            shape.positions.ndim == 2 and shape.positions.shape[1] == 3 and shape.triangles.ndim == 2 and shape.triangles.shape[1] == 3 and len(shape.triangles)
        )
        if not whole or not np.isfinite(shape.positions).all() or min(shape.triangles.min(), shape.vertex_particle.min()) < 0:
            raise ValueError("positions (P,3), finite, and triangles (F,3) are wanted")
        shape.positions[shape.particle_triangles]
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FileError(f"is not the shape of a baseline ({error})", file=str(beside)) from None
    return shape
