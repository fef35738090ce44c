"""Arguments of Python callers: anything may come in them, and what is of another kind is refused by the argument's name."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from pathlib import Path

from garmentcad.errors import InputError
from garmentcad.pattern.parse import shown
from garmentcad.pattern.spec import GarmentSpec


def as_number(value: object, key: str, wanted: str) -> float:
    """An argument as a finite number. InputError where it is none."""
    try:
        if isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
    except OverflowError:
        pass
    raise InputError(f"{wanted} is wanted, came {shown(value)}", key=key)


def as_values(values: object) -> dict[str, float]:
    """Values of parameters by name; none for None. InputError for anything else."""
    values = {} if values is None else values
    if not isinstance(values, Mapping) or not all(isinstance(name, str) for name in values):
        raise InputError(f"a mapping of parameter names to numbers is wanted, came {shown(values)}", key="values")
    return {name: as_number(value, f"values.{name}", "a number") for name, value in values.items()}


def refuse_unnamed(named: object, key: str, made: type | None = None) -> None:
    """InputError for what is neither a name nor a file nor, where that may come, one that was made."""
    if not isinstance(named, (str, Path) if made is None else (str, Path, made)):
        wanted = "a name or a file" if made is None else f"a name, a file or a {made.__name__}"
        raise InputError(f"{wanted} is wanted, came {shown(named)}", key=key)


def refuse_no_garment(spec: object) -> None:
    """InputError for what is neither a name or file of a garment nor one that was read."""
    if not isinstance(spec, (str, Path, GarmentSpec)):
        raise InputError(f"a garment is a shipped name, a file or a GarmentSpec, came {shown(spec)}", key="spec")
