"""Two result folders side by side: table, file and picture of what differs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from garmentcad.analysis.figures import Figure, figures
from garmentcad.analysis.surface_distance import Surface, SurfaceDistance, surface_distance
from garmentcad.errors import InputError, MeshError
from garmentcad.export.color_map import painted, painted_alike
from garmentcad.export.fit import csv_text, plain_table, shown
from garmentcad.export.obj import read_garment_obj
from garmentcad.export.picture import HEIGHT_PX, write_picture
from garmentcad.export.result_folder import Result, read_report, read_result_folder
from garmentcad.export.side_by_side import Exhibit, draw_side_by_side
from garmentcad.io.atomic import write_atomic

COMPARED = ("garment", "fabric", "mannequin", "grid_mm", "seed", "mode", "status", "spec_sha256", "fabric_sha256", "mannequin_sha256", "state_sha256")
FORMATS = (".json", ".csv", ".png")


@dataclass(frozen=True)
class Worn:
    """What a comparison needs of a result folder; every version of the program writes it alike."""

    report: dict[str, Any]
    surface: Surface


def read_worn(folder: str | Path) -> Worn:
    """report.json and garment.obj of a result folder. Raises FileError or MeshError naming what is missing or torn."""
    report, file = read_report(folder), Path(folder) / "garment.obj"
    surface = Surface(*read_garment_obj(file))
    for name, there in (("particles", len(surface.positions)), ("triangles", len(surface.triangles))):
        if report.get(name, there) != there:
            raise MeshError(f"holds {there} {name}; report.json has {report[name]}", file=str(file))
    return Worn(report, surface)


@dataclass(frozen=True)
class Comparison:
    """status: how A and B ended; unlike: identity that differs, name -> (A, B); rows: every figure that one of both has, name -> (A, B); shape: how far the
    surfaces lie apart."""

    status: tuple[str, str]
    unlike: dict[str, tuple[Any, Any]]
    rows: dict[str, tuple[Figure | None, Figure | None]]
    shape: SurfaceDistance


def compare(a: Worn, b: Worn) -> Comparison:
    """Compare two drapes of any garments, fabrics, sizes, lattices or versions."""
    unlike = {key: (a.report.get(key), b.report.get(key)) for key in COMPARED if a.report.get(key) != b.report.get(key)}
    versions_a, versions_b = a.report.get("versions", {}), b.report.get("versions", {})
    unlike |= {
        name: (versions_a.get(name), versions_b.get(name)) for name in sorted({*versions_a, *versions_b}) if versions_a.get(name) != versions_b.get(name)
    }
    of_a, of_b = figures(a.report), figures(b.report)
    rows = {name: (of_a.get(name), of_b.get(name)) for name in dict.fromkeys((*of_a, *of_b))}
    return Comparison((str(a.report.get("status")), str(b.report.get("status"))), unlike, rows, surface_distance(a.surface, b.surface))


def difference(pair: tuple[Figure | None, Figure | None]) -> Figure:
    """B minus A; None where one of them was not measured."""
    one, other = pair
    unit = next(figure.unit for figure in pair if figure is not None)
    if one is None or other is None or one.value is None or other.value is None:
        return Figure(None, unit)
    return Figure(other.value - one.value, unit)


def comparison_data(found: Comparison) -> dict[str, Any]:
    """The comparison as plain data."""
    return {
        "schema": 1,
        "status": list(found.status),
        "unlike": {name: list(pair) for name, pair in found.unlike.items()},
        "shape_mm": {"rms": found.shape.rms_mm, "max": found.shape.max_mm},
        "figures": {name: {"a": _value(pair[0]), "b": _value(pair[1]), "difference": difference(pair).value} for name, pair in found.rows.items()},
    }


def comparison_tables(found: Comparison) -> list[Table]:
    """For the terminal: what the two are, and every figure that one of both has."""
    identity = plain_table("", "A", "B")
    for name, pair in found.unlike.items():
        if name in ("fabric_sha256", "mannequin_sha256") and name.removesuffix("_sha256") not in found.unlike:
            identity.add_row(f"{name.removesuffix('_sha256')}, other values of one name", *("–" if value is None else value[:8] for value in pair))
        if not name.endswith("sha256"):
            identity.add_row(name, *("–" if value is None else str(value) for value in pair))
    table = plain_table("quantity", "A", "B", "B - A")
    table.add_column("unit")
    for name, values in found.rows.items():
        if any(_value(figure) is not None for figure in values):
            apart = difference(values)
            table.add_row(name, shown(values[0]), shown(values[1]), shown(apart), apart.unit)
    for name, distance in (("surfaces apart, RMS", found.shape.rms_mm), ("surfaces apart, at most", found.shape.max_mm)):
        table.add_row(name, "", "", f"{distance:.1f}", "mm")
    return [part for part in (identity, table) if part.row_count]


def write_comparison(path: Path, folders: tuple[Path, Path], found: Comparison, view: str, map_name: str) -> Path:
    """Write a comparison as .json, .csv (quantity, a, b, difference, unit) or .png (see `draw_comparison`; both folders must be of this version, then)."""
    if path.suffix not in FORMATS:
        raise InputError(f"cannot write '{path.suffix or path.name}'; allowed are {', '.join(FORMATS)}", file=str(path))
    if path.suffix == ".png":
        a, b = (read_result_folder(folder) for folder in folders)
        return write_picture(path, draw_comparison(a, b, found, view, map_name))
    if path.suffix == ".json":
        return write_atomic(path, json.dumps(comparison_data(found), indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    rows = []
    for name, pair in found.rows.items():
        apart = difference(pair)
        rows.append((name, *("" if value is None else f"{value:.9g}" for value in (_value(pair[0]), _value(pair[1]), apart.value)), apart.unit))
    return write_atomic(path, csv_text(("quantity", "a", "b", "difference", "unit"), rows))


def draw_comparison(a: Result, b: Result, found: Comparison, view: str = "front", map_name: str = "none", height_px: int = HEIGHT_PX) -> Any:
    """A PIL image: A and B from one place at one scale, with a map that has one scale for both, then A in the colors of its distance from B."""
    maps: list[Any] = [None, None]
    if map_name != "none":
        for result in (a, b):
            if map_name not in result.maps:
                raise InputError(f"{result.report.get('garment')} has no map '{map_name}'; it has: {', '.join(result.maps) or 'none'}", key="map_name")
        maps = painted_alike(map_name, a.maps[map_name], b.maps[map_name])
    titles = [f"{letter}  {' · '.join(str(result.report.get(key)) for key in COMPARED[:3])}" for letter, result in (("A", a), ("B", b))]
    titles.append(f"A: distance from B; both ways RMS {found.shape.rms_mm:.1f} mm, at most {found.shape.max_mm:.1f} mm")
    maps.append(painted("apart", found.shape.from_first_mm))
    exhibits = [Exhibit(title, result.state.positions, result.cloth, result.mannequin, own) for title, result, own in zip(titles, (a, b, a), maps)]
    return draw_side_by_side(exhibits, (view,), height_px)


def _value(figure: Figure | None) -> float | None:
    return None if figure is None else figure.value
