"""A KES sheet: the values of one fabric as the Kawabata testers print them, each with its source or the rule by which it was estimated.

Units are the testers' (`quantity.QUANTITIES`); SI begins in `material.py`. Keys are dotted: `W`, `B.warp`. A value measured on warp and weft but printed
only as their mean goes under `mean`. A sheet may have gaps; `missing.complete` fills them by stated rules.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from garmentcad.errors import FabricError, did_you_mean
from garmentcad.fabric.quantity import BENDING_WAYS, KEYS, QUANTITIES, quantity_of
from garmentcad.schema_version import SchemaVersion

SHEAR_WINDOW_DEG = (0.5, 2.5)
SHEARED_DEG = 8.0  # how far KES-FB1 shears
_PAIR = f"a rising pair from {SHEAR_WINDOW_DEG[0]:g} to {SHEARED_DEG:g} is allowed, such as {list(SHEAR_WINDOW_DEG)}; nearer 0 friction is still being drawn"
_Number = Annotated[float, Field(strict=True)]  # neither true nor a number in quotes


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class KesValue(_Model):
    """One printed number. `source` says who measured it, `estimate` the rule by which it was guessed; neither: the sheet's own `source`."""

    value: float = Field(strict=True, allow_inf_nan=False)
    source: str | None = Field(default=None, min_length=1)
    estimate: str | None = Field(default=None, min_length=1)
    note: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _number_alone(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and "estimate" in data and data["estimate"] is None:
            # left out, the value would count as measured by whom the sheet names
            raise PydanticCustomError("no_rule", "`estimate` is empty; give the rule by which the value was estimated")
        return data if isinstance(data, Mapping | BaseModel) else {"value": data}


class Ways(_Model):
    """A value with directions. A number, or a number with its source, where no direction stands is the mean."""

    warp: KesValue | None = None
    weft: KesValue | None = None
    mean: KesValue | None = None

    @model_validator(mode="before")
    @classmethod
    def _no_direction(cls, data: Any) -> Any:
        if data is None:  # a key that waits for its values, as `T0:` may
            return {}
        alone = isinstance(data, int | float) or (isinstance(data, Mapping) and "value" in data and not set(data) & set(BENDING_WAYS))
        return {"mean": data} if alone else data


class BendingWays(Ways):
    """A bending value, measured on the bias too."""

    bias: KesValue | None = None


class CalibratedLaw(_Model):
    """Law values, in tester units, with which the virtual testers print this sheet. They hold only for the sheet with this hash."""

    sheet_sha256: str = Field(pattern="^[0-9a-f]{64}$")
    values: dict[str, _Number] = Field(min_length=1)


class KesSheet(_Model):
    """One fabric. Raised by `sheet_from` and by pydantic alike: unknown keys, values that are not finite numbers, impossible ranges, no source.

    source: who measured the values that name nothing themselves. sources: short names for citations; then every `source` is one of them.
    shear_window_deg: the angles between which G was read as a slope, inside the tester's 0 to 8 degrees.
    """

    schema_: SchemaVersion = Field(alias="schema")
    name: str = Field(min_length=1, max_length=80)
    description: str = ""
    fibre: str | None = None
    weave: str | None = None
    source: str | None = Field(default=None, min_length=1)
    sources: dict[str, str] = Field(default_factory=dict)
    shear_window_deg: tuple[_Number, _Number] = SHEAR_WINDOW_DEG
    W: KesValue | None = None
    T0: KesValue | None = None
    Tm: KesValue | None = None
    Fm: KesValue | None = None
    LT: Ways = Field(default_factory=Ways)
    WT: Ways = Field(default_factory=Ways)
    RT: Ways = Field(default_factory=Ways)
    EMT: Ways = Field(default_factory=Ways)
    G: Ways = Field(default_factory=Ways)
    HG: Ways = Field(default_factory=Ways, alias="2HG")
    HG5: Ways = Field(default_factory=Ways, alias="2HG5")
    B: BendingWays = Field(default_factory=BendingWays)
    HB: BendingWays = Field(default_factory=BendingWays, alias="2HB")
    MIU: Ways = Field(default_factory=Ways)
    MMD: Ways = Field(default_factory=Ways)
    SMD: Ways = Field(default_factory=Ways)
    LC: KesValue | None = None
    WC: KesValue | None = None
    RC: KesValue | None = None
    law: CalibratedLaw | None = None

    @model_validator(mode="after")
    def _values_are_possible(self) -> KesSheet:
        low, high = self.shear_window_deg
        if not SHEAR_WINDOW_DEG[0] <= low < high <= SHEARED_DEG:
            raise FabricError(f"{low:g} to {high:g} degrees came; {_PAIR}", key="shear_window_deg")
        for key, value in self.values().items():
            low, high = quantity_of(key).possible
            if not low <= value.value <= high:
                quantity = quantity_of(key)
                slip = f" ({quantity.slip})" if quantity.slip else ""
                raise FabricError(f"{value.value!r} {quantity.unit} is impossible; {low:g} to {high:g} {quantity.unit} is allowed{slip}", key=key)
            if value.source and value.estimate:
                raise FabricError("both `source` and `estimate` are given; a value is measured or estimated, not both", key=key)
            named = value.source or (None if value.estimate else self.source)
            if named is None and value.estimate is None:
                raise FabricError("no source: give the value a `source` or an `estimate` with its rule, or the whole sheet a `source`", key=key)
            if named is not None and self.sources and named not in self.sources:
                raise FabricError(f"source {named[:100]!r} is not among the sheet's `sources`{did_you_mean(named, self.sources)}", key=key)
        for key, number in (self.law.values if self.law else {}).items():
            if key not in KEYS:
                raise FabricError(f"law value {number!r} for {key!r}, which no sheet has{did_you_mean(key, KEYS)}", key=f"law.values.{key}")
            low, high = quantity_of(key).possible
            if not low <= number <= high:
                raise FabricError(f"law value {number!r}; {low:g} to {high:g} is allowed", key=f"law.values.{key}")
        return self

    def get(self, key: str) -> KesValue | None:
        """The value under a key, or None where the sheet has a gap. FabricError for a key that no sheet has."""
        quantity = quantity_of(key)
        way = key.partition(".")[2]
        if quantity.directions and not way:
            raise FabricError(f"{key} needs a direction{did_you_mean('', quantity.directions)}", key=key)
        entry = getattr(self, _FIELD.get(quantity.name, quantity.name))
        return getattr(entry, way) if way else entry

    def number(self, key: str) -> float:
        """The number under a key, in the testers' unit. FabricError where the sheet has a gap (`missing.complete` fills gaps)."""
        value = self.get(key)
        if value is None:
            raise FabricError(f"sheet {self.name!r} has no value; complete the sheet first", key=key)
        return value.value

    def values(self) -> dict[str, KesValue]:
        """All values that the sheet has, in the order of `quantity.KEYS`."""
        return {key: value for key in KEYS if (value := self.get(key)) is not None}

    def origin(self, key: str) -> str:
        """Who measured the value under a key, or the rule of its estimate."""
        value = self.get(key)
        if value is None:
            return ""
        if value.estimate:
            return f"estimate: {value.estimate}"
        named = value.source or self.source or ""
        return self.sources.get(named, named)

    def with_values(self, values: Mapping[str, KesValue]) -> KesSheet:
        """A copy with these values in place of its own; without `law` where that changes a number, because law values are solved for the numbers of a sheet.

        FabricError for an unknown key, a value that is no KesValue and an impossible number. The copy may have gaps as any sheet may: what would fill them,
        and whether that is possible beside the new values, is seen by `missing.complete`, which `load_fabric` and every drape call.
        """
        data = sheet_data(self)
        for key, value in values.items():
            name, _, way = key.partition(".")
            quantity_of(key)
            if not isinstance(value, KesValue):
                allowed = "a KesValue(value=...) with its `source` or `estimate` is allowed"
                raise FabricError(f"{value!r:.100} came, of the type {type(value).__name__}; {allowed}", key=key)
            entry = value.model_dump(exclude_none=True)
            if way:
                data.setdefault(name, {})[way] = entry
            else:
                data[name] = entry
        changed = sheet_from(data)
        return changed if sheet_sha256(changed) == sheet_sha256(self) else changed.model_copy(update={"law": None})


_FIELD = {field.alias: name for name, field in KesSheet.model_fields.items() if field.alias}


def sheet_data(sheet: KesSheet) -> dict[str, Any]:
    """The sheet as plain dicts, text and numbers, as a fabric file holds it: gaps left out, a value that has nothing but its number is that number."""

    def short(entry: Any) -> Any:
        if isinstance(entry, dict):
            return entry["value"] if set(entry) == {"value"} and not isinstance(entry["value"], str) else {key: short(value) for key, value in entry.items()}
        return entry

    data = sheet.model_dump(by_alias=True, exclude_none=True, exclude={"law"})
    data["shear_window_deg"] = list(sheet.shear_window_deg)
    shortened = {key: short(value) for key, value in data.items() if value not in ({}, "")}
    if sheet.law:
        shortened["law"] = sheet.law.model_dump()
    return shortened


def sheet_from(data: Any, file: str | None = None) -> KesSheet:
    """A sheet from plain data (what a YAML file holds). FabricError says what came, where, and what is allowed; `file` names the source in it."""
    if not isinstance(data, Mapping):
        raise FabricError(f"a fabric file holds a mapping of keys to values; {type(data).__name__} came", file=file)
    try:
        return KesSheet.model_validate(dict(data))
    except ValidationError as fault:
        first = min(fault.errors(), key=lambda one: one["type"] == "missing")  # what is written says more than what it leaves out
        cause = first.get("ctx", {}).get("error")
        more = f" (and {fault.error_count() - 1} more)" if fault.error_count() > 1 else ""
        if isinstance(cause, FabricError):
            raise FabricError(cause.message + more, file=file, key=cause.key) from None
        key = ".".join(str(part) for part in first["loc"])
        raise FabricError(_refusal(first) + more, file=file, key=key or None) from None


def _refusal(fault: Any) -> str:
    *where, last = [str(part) for part in fault["loc"]] or [""]
    kind, text = fault["type"], isinstance(fault["input"], str)
    came = ("nothing" if fault["input"] is None else f"{fault['input']!r}"[:100]) + " came"
    quantity = QUANTITIES.get((where or [last])[0])
    if kind == "extra_forbidden":
        near = did_you_mean(last, _allowed_keys(where))
        return f"unknown key {last[:100]!r}{'' if near.startswith(';') else _hint(last, where)}{near}"
    if kind == "missing":
        return f"the key {last!r} is missing; it is required"
    if "shear_window_deg" in (last, *where):
        return f"{came}; {_PAIR}"
    if kind == "dict_type":
        return f"{came}; a mapping of {'short names to citations' if last == 'sources' else 'keys of the sheet to numbers'} is allowed"
    if kind == "model_type" and quantity is None:
        return f"{came}; a mapping is allowed, with the keys {', '.join(_allowed_keys([*where, last]))}"
    if kind == "model_type" or last == "value" or kind.startswith(("float", "finite")):
        unit = f" in {quantity.unit}" if quantity and quantity.unit != "-" else ""
        ways = f" (the mean) or a mapping with the keys {', '.join(_allowed_keys([last]))}" if kind == "model_type" else ""
        return f"{came}; a finite number{unit}{ways} is allowed{'; numbers have a decimal point, and neither unit nor quotes' if text else ''}"
    if kind == "string_type":
        return f"{came}; a text is allowed, a number in quotes"
    if kind == "string_too_short":
        return f"{came}; a text that is not empty is allowed"
    return f"{came}; {fault['msg'][0].lower()}{fault['msg'][1:]}"


def _hint(key: str, where: list[str]) -> str:
    """What to say of an unknown key that is like no other: units and directions that stand where they do not belong."""
    if not where and key.lower() in BENDING_WAYS:
        return "; directions stand below a value, as in `B: {warp: 0.1}`"
    meant = [where[0]] if where else [name for name in QUANTITIES if re.match(rf"{name}[^a-z0-9]", key, re.I)]
    quantity = QUANTITIES.get(meant[0]) if meant else None
    if quantity is None:
        return ""
    unit = "without a unit" if quantity.unit == "-" else f"in {quantity.unit}"
    if not where:
        below = f", directions below it as in `{quantity.name}: {{warp: ...}}`" if quantity.directions else ""
        return f"; the key is {quantity.name} alone, its number always {unit}{below}"
    if key in BENDING_WAYS and not quantity.directions:
        return f"; {quantity.name} has no directions, it is one number {unit}"
    return f"; {quantity.name} is always {unit}" if key in ("unit", "units") else ""


def _allowed_keys(where: list[str]) -> list[str]:
    """Keys that may stand at a place of the file."""
    if not where:
        return [field.alias or name for name, field in KesSheet.model_fields.items()]
    if where == ["law"]:
        return list(CalibratedLaw.model_fields)
    directions = quantity_of(where[0]).directions
    return list(directions) if directions and len(where) == 1 else list(KesValue.model_fields)


def sheet_sha256(sheet: KesSheet) -> str:
    """Hash of the numbers of a sheet (no names, sources or law). A calibration belongs to the hash of the completed sheet."""
    numbers: dict[str, Any] = {key: value.value for key, value in sheet.values().items()}
    if sheet.shear_window_deg != SHEAR_WINDOW_DEG:
        numbers["shear_window_deg"] = sheet.shear_window_deg
    return hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()


def drape_sha256(sheet: KesSheet) -> str:
    """Hash of all that a drape takes from a completed sheet: its numbers, the law values that were solved for them, and the fibre, which presses folds."""
    law = dict(sheet.law.values) if sheet.law is not None and is_calibrated(sheet) else {}
    return hashlib.sha256(json.dumps([sheet_sha256(sheet), law, sheet.fibre], sort_keys=True).encode()).hexdigest()


def is_calibrated(sheet: KesSheet) -> bool:
    """Whether a completed sheet carries law values that were solved for exactly these numbers."""
    return sheet.law is not None and sheet.law.sheet_sha256 == sheet_sha256(sheet)
