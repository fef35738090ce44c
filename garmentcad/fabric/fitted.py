"""Values that were fitted to tests rather than printed by a tester, with their bounds, and the sheet that holds them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from garmentcad.errors import FabricError
from garmentcad.fabric.given import Given
from garmentcad.fabric.missing import FILLED
from garmentcad.fabric.sheet import KesSheet, sheet_from


class FittedValue(NamedTuple):
    """A value of a sheet in the testers' unit, the bounds that the test leaves open, how it was had, and of what: keys of readings (`E5.warp`, `W`) or of loops
    (`RecordedLoop.key`). estimate: believed, not measured."""

    key: str
    value: float
    low: float
    high: float
    how: str
    of: tuple[str, ...]
    estimate: bool = False

    def note(self) -> str:
        """The bounds and the way, as the sheet keeps them."""
        return f"{self.low:.4g} to {self.high:.4g}; {self.how}"


def fitted_sheet(
    name: str,
    fitted: Iterable[FittedValue],
    given: Mapping[str, Given],
    files: Mapping[str, str],
    sources: Mapping[str, str],
    texts: Mapping[str, str],
) -> KesSheet:
    """A sheet of fitted values, each with its bounds as a note, and of values that were given as they are. What neither gave stays blank. The sheet's `sources`
    say which files hold what was given and what was fitted to.

    files: in which each of the keys stands that the fitted values are `of`; sources: who measured what is in a file; texts: entries of the sheet in words.
    FabricError for a key that comes twice and for what `sheet_from` refuses.
    """
    data: dict[str, Any] = {"schema": 1, "name": name, **texts, "sources": {}}
    origins: dict[str, str] = {}

    def put(key: str, entry: dict[str, Any], source: str, origin: str) -> None:
        if key in origins:
            raise FabricError(f"{key} comes twice, {origins[key]} and {origin}; once is allowed, leave one of them out", key=key)
        origins[key] = data["sources"][source] = origin
        quantity, _, way = key.partition(".")
        entry = entry if "estimate" in entry else entry | {"source": source}
        if way:
            data.setdefault(quantity, {})[way] = entry
        else:
            data[quantity] = entry

    paths = {one.file for one in given.values()} | set(files.values())
    alone = Counter(Path(path).name for path in paths)
    # two files of one name are told apart by their folders
    called = {path: Path(path).name if alone[Path(path).name] == 1 else path for path in paths}
    cited = {path: file + (f" ({sources[path]})" if path in sources else "") for path, file in called.items()}
    for key, one in given.items():
        put(key, {"value": one.value}, called[one.file], f"given in {cited[one.file]}")
    for value in fitted:
        behind = dict.fromkeys(files[key] for key in value.of)
        names, sources_of = (", ".join(terms[path] for path in behind) for terms in (called, cited))
        said = {"estimate" if value.estimate else "note": value.note()}
        put(value.key, {"value": float(f"{value.value:.5g}")} | said, f"fit of {names}", f"fitted to {sources_of} by garmentcad fabric fit")
    blank = [key for key in FILLED if not _given(key, set(origins))]
    how = "Fitted to tests; the note of each fitted value holds its bounds." + (f" Not measured: {', '.join(blank)}." if blank else "")
    data["description"] = f"{texts['description']}\n{how}" if "description" in texts else how
    return sheet_from(data)


def _given(key: str, seen: set[str]) -> bool:
    name, _, way = key.partition(".")
    by_mean = way in ("warp", "weft") and f"{name}.mean" in seen
    by_both = way == "mean" and {f"{name}.warp", f"{name}.weft"} <= seen
    by_definition = name == "WT" and {f"{other}.{way}" for other in ("LT", "EMT")} <= seen
    return key in seen or by_mean or by_both or by_definition
