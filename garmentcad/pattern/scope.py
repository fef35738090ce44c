"""The names that expressions of one garment may use, and the door through which every number of a spec goes."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.geometry.curve import Point
from garmentcad.pattern.expression import FUNCTIONS, evaluate
from garmentcad.pattern.spec import GarmentSpec, Number, PointSpec

MAX_COORDINATE_MM = 20_000.0  # no panel is that large; keeps a slip in an expression from asking for a million points


class Scope:
    """Measurements, parameters and values of a garment. `number` and `point` evaluate; errors carry the key path given."""

    def __init__(self, names: dict[str, float], given: Collection[str] = ()) -> None:
        self.names, self.given = names, given  # given: all names of the spec, those that have no value yet among them

    def number(self, expression: Number, key: str, low: float | None = None, high: float | None = None) -> float:
        """Value of a number or expression; SpecError outside [low, high]."""
        value = evaluate(expression, self.names, key, self.given)
        if (low is not None and value < low) or (high is not None and value > high):
            came = f"{value:g}" + (f" (from {expression!r})" if isinstance(expression, str) else "")
            allowed = f"{low:g} to {high:g}" if low is not None and high is not None else f"at least {low:g}" if low is not None else f"at most {high:g}"
            raise SpecError(f"came {came}; allowed is {allowed}", key=key)
        return value

    def positive(self, expression: Number, key: str) -> float:
        """Value of a length that must be larger than zero."""
        value = self.number(expression, key, high=MAX_COORDINATE_MM)
        if value <= 0.0:
            raise SpecError(f"came {value:g}; it must be larger than 0", key=key)
        return value

    def point(self, pair: PointSpec, key: str) -> Point:
        """Point in panel millimetres."""
        x, y = (self.number(pair[k], f"{key}.{k}", -MAX_COORDINATE_MM, MAX_COORDINATE_MM) for k in (0, 1))
        return x, y


def with_values(spec: GarmentSpec, values: Mapping[str, float]) -> GarmentSpec:
    """The garment with other values of parameters. SpecError for a name that is none; whether a value lies in its range is seen when the garment is drafted."""
    for name in values:
        if name in spec.values:
            raise SpecError(f"{name!r} is worked out from parameters and measurements, under values; set a parameter", file=spec.file, key=f"values.{name}")
        if name not in spec.parameters:
            raise SpecError(f"no parameter is called {name!r}{did_you_mean(name, spec.parameters)}", file=spec.file, key="parameters")
    return spec.model_copy(
        update={"parameters": {name: own.model_copy(update={"value": values.get(name, own.value)}) for name, own in spec.parameters.items()}}
    )


def make_scope(spec: GarmentSpec, measurements_mm: Mapping[str, float]) -> tuple[Scope, dict[str, float]]:
    """Scope of a garment and its evaluated parameters, each in its range."""
    scope = Scope(dict(measurements_mm), {*spec.parameters, *spec.values})
    parameters: dict[str, float] = {}
    for name, parameter in spec.parameters.items():
        key = f"parameters.{name}"
        _check_new(name, scope, key)
        low, high = (None, None) if parameter.range is None else (scope.number(parameter.range[k], f"{key}.range.{k}") for k in (0, 1))
        if low is not None and high is not None and low > high:
            raise SpecError(f"the smallest value {low:g} is larger than the largest {high:g}", key=f"{key}.range")
        parameters[name] = scope.number(parameter.value, f"{key}.value", low, high)
        scope.names[name] = parameters[name]
    for name, expression in spec.values.items():
        key = f"values.{name}"
        _check_new(name, scope, key)
        scope.names[name] = scope.number(expression, key)
    return scope, parameters


def _check_new(name: str, scope: Scope, key: str) -> None:
    if name in scope.names or name in FUNCTIONS:
        raise SpecError(f"the name {name!r} is taken by a measurement, a parameter or a value; choose another", key=key)
