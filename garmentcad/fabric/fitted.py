"""Values that were fitted to tests rather than printed by a tester, with their bounds, and the sheet that holds them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from garmentcad.errors import FabricError
from garmentcad.fabric.missing import FILLED
from garmentcad.fabric.sheet import KesSheet, sheet_from


class FittedValue(NamedTuple):
    """A value of a sheet in the testers' unit, the bounds that the test leaves open, and how it was had from what."""

    key: str
    value: float
    low: float
    high: float
    how: str

    def note(self) -> str:
        """The bounds and the way, as the sheet keeps them."""
        return f"{self.low:.4g} to {self.high:.4g}; {self.how}"


def fitted_sheet(name: str, source: str, fitted: Iterable[FittedValue], printed: Mapping[str, float]) -> KesSheet:
    """A sheet of fitted values, each with its bounds as a note, and of values that a tester printed. What neither gave stays blank.

    source: who measured. FabricError for a key that comes twice and for what `sheet_from` refuses.
    """
    data: dict[str, Any] = {"schema": 1, "name": name, "source": source}
    seen: set[str] = set()

    def put(key: str, entry: Any) -> None:
        if key in seen:
            raise FabricError(f"{key} comes twice; once is allowed, leave one of them out", key=key)
        seen.add(key)
        quantity, _, way = key.partition(".")
        if way:
            data.setdefault(quantity, {})[way] = entry
        else:
            data[quantity] = entry

    for key, number in printed.items():
        put(key, number)
    for value in fitted:
        put(value.key, {"value": float(f"{value.value:.5g}"), "note": value.note()})
    blank = [key for key in FILLED if not _given(key, seen)]
    data["description"] = "Fitted to tests; the note of each fitted value holds its bounds." + (f" Not measured: {', '.join(blank)}." if blank else "")
    return sheet_from(data)


def _given(key: str, seen: set[str]) -> bool:
    name, _, way = key.partition(".")
    by_mean = way in ("warp", "weft") and f"{name}.mean" in seen
    by_both = way == "mean" and {f"{name}.warp", f"{name}.weft"} <= seen
    by_definition = name == "WT" and {f"{other}.{way}" for other in ("LT", "EMT")} <= seen
    return key in seen or by_mean or by_both or by_definition
