"""The drapemeter: measured fabrics under what is not known of them, nodes over stiffness, all shipped sheets, and what lattice and time step change.

`python -m tools.drape_study` runs every lay that has no committed row yet and writes docs/studies/drapemeter.md; with a text it runs only cases with that text
in their name. Cases come lay by lay: a study that was stopped has all of them in as many lays as it came to.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from garmentcad import __version__
from garmentcad.fabric.material import MaterialTable
from garmentcad.fabric.missing import complete
from garmentcad.fabric.sheet import KesSheet, KesValue, sheet_sha256
from garmentcad.io.atomic import write_atomic
from garmentcad.io.fabric_file import fabric_names, fabric_path, load_fabric
from garmentcad.io.kes_csv import read_kes_csv
from garmentcad.rigs.cusick import PROCEDURE, USUAL, Drape, Drapemeter
from garmentcad.rigs.kes import sheet_materials
from garmentcad.simulation.study import Row, StudyCase, run_study
from tools.study import FOLDER

COMMAND = "python -m tools.drape_study"
GRID_MM, FINE_MM, FINEST_MM = 10.0, 5.0, 2.5
LAYS, GRID_LAYS, STEP_LAYS = 5, 10, 3
FINEST_LAYS = 1  # one takes ten minutes to half an hour and more
# Drape coefficient and nodes. Source: Matsudaira et al. 2015, J. Textile Eng. 61(6) 69-73, a public transcription of its tables; the disc is not told,
# 12.7/25.4 cm is likely.
MEASURED = {
    "MAT15-A": ("cotton broad", 82.9, 2),
    "MAT15-B": ("wool tropical", 49.8, 5),
    "MAT15-C": ("polyester tropical", 50.7, 5),
    "MAT15-F": ("polyester faille", 28.3, 7),
}
KNOWN = ("W", "T0", "B.mean", "2HB.mean")  # what the sheets of these four hold; all else is by the rules for missing values
SHEARS = (0.3, 1.0, 3.0)  # gf/(cm.deg), beside the rule's
DISCS = ("12.7/25.4", "18/30")
FOUR_AT_MM = {"measured": GRID_MM, "measured-fine": FINE_MM, "measured-finest": FINEST_MM}  # parts of these four
NODES_AT_MM = {"nodes": GRID_MM, "nodes-fine": FINE_MM, "nodes-finest": FINEST_MM}  # synthetic sheets, each part those that the one before does not resolve
AT_MM = FOUR_AT_MM | NODES_AT_MM
SYNTHETIC_W = 15.0  # mg/cm2
SYNTHETIC = (
    (0.0008, 0.025), (0.0015, 0.04), (0.0018, 0.045), (0.0022, 0.05), (0.003, 0.06), (0.006, 0.1), (0.012, 0.16), (0.025, 0.25), (0.05, 0.4), (0.1, 0.63),
    (0.2, 1.0), (0.28, 1.25), (0.4, 1.6), (0.8, 2.5),
)  # fmt: skip  # B, G: G as B^(2/3)
SYNTHETIC_SHEETS = {f"synthetic B {bending:g} G {shear:g}": (bending, shear) for bending, shear in SYNTHETIC}
COMPARED = (
    "viscose-lining",
    "polyester-faille",
    "cotton-voile",
    "wool-tropical",
    "wool-suiting",
    "cotton-broad",
    "polycotton-trousering",
)  # from the softest shipped sheet to the stiffest
SHIFTS = (0.25, 0.5)  # of a cell, along and across
ORIGIN_AT_MM = {"origin": GRID_MM, "origin-fine": FINE_MM}  # parts of these shifts
STEPS = (0.5, 0.25)
WAITED_S = 2.0


def bending_length_mm(bending: float) -> float:
    """(B/W)^(1/3) of a synthetic sheet, B in gf.cm2/cm: cloth that hangs bends within about this length, which the lattice must resolve."""
    return 10.0 * (1e3 * bending / SYNTHETIC_W) ** (1.0 / 3.0)


def unresolved(grid_mm: float) -> list[str]:
    """Synthetic sheets that bend within less than a spacing."""
    return [name for name, (bending, _) in SYNTHETIC_SHEETS.items() if bending_length_mm(bending) < grid_mm]


def sheets() -> dict[str, KesSheet]:
    """Every sheet of the study by its name in the cases."""
    found = {name: load_fabric(fabric_path(name)).sheet for name in fabric_names()}
    for printed in read_kes_csv(FOLDER / "measured-fabrics.csv")[0]:
        if printed.name in MEASURED:
            sheet = KesSheet(schema=1, name=printed.name, source=printed.source).with_values(
                {key: value for key, value in printed.values().items() if key in KNOWN}
            )
            found[f"{printed.name} G rule"] = sheet
            for shear in SHEARS:
                found[f"{printed.name} G {shear:g}"] = sheet.with_values({"G.mean": KesValue(value=shear, estimate="varied")})
    for name, (bending, shear) in SYNTHETIC_SHEETS.items():
        values = {"W": SYNTHETIC_W, "B.mean": bending, "G.mean": shear}
        made = KesSheet(schema=1, name="synthetic").with_values({key: KesValue(value=value, estimate="made up") for key, value in values.items()})
        found[name] = made
    return {name: complete(sheet).sheet for name, sheet in found.items()}


def study_cases(known: Mapping[str, KesSheet]) -> list[StudyCase]:
    """One case a lay. It belongs to its sheet, its law values and what is done to the specimen."""

    def case(part: str, name: str, lay: int, words: str = "", **parameters: Any) -> StudyCase:
        sheet = known[name]
        law = hashlib.sha256(json.dumps(dict(sheet.law.values) if sheet.law else {}, sort_keys=True).encode()).hexdigest()
        full = " ".join(filter(None, (part, name, words, f"lay {lay}")))
        return StudyCase(full, sheet_sha256(sheet), name, "", __version__, {"part": part, "procedure": PROCEDURE, "law_sha256": law, "lay": lay, **parameters})

    found = []
    for lay in range(GRID_LAYS):
        for part, grid_mm in FOUR_AT_MM.items():
            if lay < (FINEST_LAYS if grid_mm == FINEST_MM else LAYS):
                found += [case(part, name, lay, disc, geometry=disc) for name in known if name.startswith("MAT15") for disc in DISCS]
        if lay < LAYS:
            found += [case("nodes", name, lay) for name in SYNTHETIC_SHEETS]
            found += [case("nodes-fine", name, lay) for name in unresolved(GRID_MM)]
            found += [case("shipped", name, lay) for name in fabric_names()]
        if lay < FINEST_LAYS:
            found += [case("nodes-finest", name, lay) for name in unresolved(FINE_MM)]
        found += [case("grid", name, lay) for name in COMPARED]
        if lay < LAYS:
            found += [case(part, name, lay) for part in ORIGIN_AT_MM for name in COMPARED]
        if lay < STEP_LAYS:
            found += [case("step", name, lay) for name in COMPARED]
    return found


def figures(drape: Drape) -> dict[str, Any]:
    """What is kept of a lay."""
    rim = drape.shadow.rim_mm
    return {
        "status": drape.status,
        "dc_percent": drape.dc_percent,
        "nodes": drape.shadow.nodes,
        "rim_max_mm": float(rim.max()),
        "rim_min_mm": float(rim.min()),
        "lowest_mm": drape.lowest_mm,
    }


def run_case(case: StudyCase, materials: MaterialTable) -> Mapping[str, Any]:
    """Figures of one lay, and of what the part compares it with."""
    began = time.perf_counter()
    part, lay = case.parameters["part"], case.parameters["lay"]
    meter = Drapemeter(materials, AT_MM.get(part, GRID_MM), case.parameters.get("geometry", USUAL))
    drape = meter.lay(lay)
    row = figures(drape)
    if part in ("grid", "origin-fine"):
        coarse, meter = meter, Drapemeter(materials, FINE_MM)
        drape = meter.taken_over(coarse, drape)
        row["fine"] = figures(drape)
    if part in ORIGIN_AT_MM:
        row["shifted"], row["anew"] = {}, {}
        for shift in SHIFTS:
            other = Drapemeter(materials, ORIGIN_AT_MM[part], origin_mm=(shift * ORIGIN_AT_MM[part],) * 2)
            row["shifted"][f"{shift:g}"] = figures(other.taken_over(meter, drape))
            if part == "origin":
                row["anew"][f"{shift:g}"] = figures(other.lay(lay))
    if part == "step":
        row["time_step"] = {f"{step:g}": figures(meter.lay(lay, step)) for step in STEPS}
        row["drift_percent_s"] = (meter.waited(drape, WAITED_S).dc_percent - drape.dc_percent) / WAITED_S
    return row | {"wall_time_s": time.perf_counter() - began}


def page(rows: Iterable[Row]) -> str:
    """The page of the study."""
    parts: dict[str, dict[str, list[Row]]] = {}
    for row in rows:
        name = row["fabric"] if row["part"] not in FOUR_AT_MM else f"{row['fabric']}, {row['geometry']}"
        parts.setdefault(row["part"], {}).setdefault(name, []).append(row)
    lines = [
        "# Drapemeter", "",
        f"Cusick's drapemeter at {GRID_MM:g} mm, disc and specimen {USUAL} cm where nothing else stands; lays differ by a random waviness of at most "
        f"0.5 mm, and are {PROCEDURE} ([rigs.md](../rigs.md)). DC in percent of the ring, nodes as maxima of the rim that stand out by 3 mm; means, and the "
        "standard deviation (SD) over lays.", "",
        f"Made by `{COMMAND}`.", "",
    ]  # fmt: skip
    for part, grid_mm in FOUR_AT_MM.items():
        if part in parts:
            lines += [*_measured(parts[part], grid_mm), ""]
    shown = {"nodes": _nodes, "shipped": _shipped, "grid": _grid, "origin": _origin, "origin-fine": _origin_fine, "step": _step}
    for part, write in shown.items():
        if part in parts:
            lines += [*write(parts), ""]
    ended = [row for row in rows if row["status"] != "converged"]
    lines.append(f"{len(ended)} of {sum(len(named) for part in parts.values() for named in part.values())} first lays did not come to rest within their time.")
    return "\n".join(lines) + "\n"


def _dc(rows: Iterable[Row], *path: str) -> np.ndarray:
    return _values(rows, "dc_percent", *path)


def _values(rows: Iterable[Row], figure: str, *path: str) -> np.ndarray:
    found = []
    for row in rows:
        value: Any = row
        for name in path:
            value = value[name]
        found.append(value[figure])
    return np.array(found, dtype=float)


def _spread(values: np.ndarray, digits: int = 1) -> str:
    return f"{values.mean():.{digits}f}" + (f" ({values.std(ddof=1):.{digits}f})" if len(values) > 1 else "")


def _table(*columns: str) -> list[str]:
    return ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]


def _measured(named: Mapping[str, list[Row]], grid_mm: float) -> list[str]:
    """Four fabrics whose drape was measured but neither their shear nor their disc."""
    means = {name: float(_dc(rows).mean()) for name, rows in named.items()}
    lines = [
        f"## Four measured fabrics at {grid_mm:g} mm", "",
        "Matsudaira et al. 2015 print W, B, 2HB, DC and nodes; shear, tension and the disc are not known. All else by the rules for missing values "
        "(G rule: 0.03 W); 2HG = 2 degrees x G. Sheets without law values.", "", "DC mean (SD), nodes:", "",
        *_table("fabric", "measured", *(f"{disc}, G {shear}" for disc in DISCS for shear in ("rule", *(f"{shear:g}" for shear in SHEARS)))),
    ]  # fmt: skip
    misses, inside, order = [], [], []
    for fabric, (words, dc, nodes) in MEASURED.items():
        cells, band = [], []
        for disc in DISCS:
            for shear in ("rule", *(f"{shear:g}" for shear in SHEARS)):
                rows = named.get(f"{fabric} G {shear}, {disc}")
                cells.append("-" if rows is None else f"{_spread(_dc(rows))}, {_values(rows, 'nodes').mean():.0f}")
                if rows is not None and shear != "rule":
                    band.append(means[f"{fabric} G {shear}, {disc}"])
        lines.append(f"| {words} | {dc:g}, {nodes} | " + " | ".join(cells) + " |")
        if len(band) == len(DISCS) * len(SHEARS):
            inside.append(f"{words} {min(band):.1f} to {max(band):.1f} ({'holds' if min(band) <= dc <= max(band) else 'does not hold'} {dc:g})")
        if missed := [f"{means[f'{fabric} G rule, {disc}'] - dc:+.1f} on {disc}" for disc in DISCS if f"{fabric} G rule, {disc}" in means]:
            misses.append(f"{words} {', '.join(missed)}")
    for disc in DISCS:
        ranked = sorted((fabric for fabric in MEASURED if f"{fabric} G rule, {disc}" in means), key=lambda fabric: -means[f"{fabric} G rule, {disc}"])
        if len(ranked) == len(MEASURED):
            order.append(f"{disc}: " + " > ".join(MEASURED[fabric][0] for fabric in ranked))
    said = {
        "Band that G from 0.3 to 3 and both discs span": inside,
        "Misses of the rule's G, in points": misses,
        "Order with the rule's G": order,
    }
    for words, found in said.items():
        if found:
            lines += ["", f"{words}: " + "; ".join(found) + "."]
    return lines


def _nodes(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """Synthetic sheets from limp to stiff."""
    finest_first = sorted(NODES_AT_MM.items(), key=lambda item: item[1])
    figures = (f"{grid_mm:g} mm: {figure}" for _, grid_mm in finest_first for figure in ("DC (SD)", "nodes (SD)", "lowest mm"))
    lines = [
        "## Nodes over stiffness", "",
        f"Synthetic sheets of {SYNTHETIC_W:g} mg/cm2 of rising B whose G goes as B^(2/3); the rest by the rules. Cloth that hangs bends within about "
        "c = (B/W)^(1/3). A lattice whose spacing is longer is too coarse for the folds, and the next finer one counts.", "",
        *_table("sheet", "c mm", *figures),
    ]  # fmt: skip
    for name in parts["nodes"]:
        cells = []
        for part, _ in finest_first:
            rows = parts.get(part, {}).get(name)
            cells.append(
                "- | - | -" if rows is None else
                f"{_spread(_dc(rows))} | {_spread(_values(rows, 'nodes'))} | {_values(rows, 'lowest_mm').mean():.0f}"
            )  # fmt: skip
        lines.append(f"| {name} | {bending_length_mm(SYNTHETIC_SHEETS[name][0]):.1f} | " + " | ".join(cells) + " |")
    return lines


def _shipped(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """All shipped sheets, softest first."""
    lines = ["## Shipped sheets", "", *_table("fabric", "lays", "DC (SD)", "nodes (SD)", "rim max mm", "rim min mm", "lowest mm")]
    for name, rows in sorted(parts["shipped"].items(), key=lambda item: _dc(item[1]).mean()):
        rims = " | ".join(f"{_values(rows, figure).mean():.0f}" for figure in ("rim_max_mm", "rim_min_mm", "lowest_mm"))
        lines.append(f"| {name} | {len(rows)} | {_spread(_dc(rows))} | {_spread(_values(rows, 'nodes'))} | {rims} |")
    return lines


def _grid(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """From 10 to 5 mm."""
    lines = [
        f"## From {GRID_MM:g} to {FINE_MM:g} mm", "",
        "Each lay at rest is taken over by the finer lattice and settles there. DC is to move by at most 2 points.", "",
        *_table("fabric", "lays", f"DC at {GRID_MM:g} mm (SD)", f"DC at {FINE_MM:g} mm (SD)", "moved, each lay", "mean", "kept their nodes"),
    ]  # fmt: skip
    for name, rows in parts["grid"].items():
        moved = _dc(rows, "fine") - _dc(rows)
        kept = int((_values(rows, "nodes", "fine") == _values(rows, "nodes")).sum())
        each = " ".join(f"{change:+.1f}" for change in moved)
        lines.append(f"| {name} | {len(rows)} | {_spread(_dc(rows))} | {_spread(_dc(rows, 'fine'))} | {each} | {moved.mean():+.1f} | {kept} |")
    return lines


def _origin(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """The lattice shifted by a part of a cell."""
    lines = [
        "## Lattice shifted", "",
        "By a part of a cell along and across. Taken over: each lay at rest settles on the shifted lattice; DC is to move by at most 1.5 points. Anew: the "
        "same lays from the start, whose folds may form otherwise.", "",
        *_table("fabric", "lays", "DC (SD)", *(f"{shift:g}, taken over: largest, mean" for shift in SHIFTS),
                *(f"{shift:g}, anew: DC (SD)" for shift in SHIFTS)),
    ]  # fmt: skip
    for name, rows in parts["origin"].items():
        moved = [_dc(rows, "shifted", f"{shift:g}") - _dc(rows) for shift in SHIFTS]
        cells = [f"{change[np.argmax(np.abs(change))]:+.1f}, {change.mean():+.1f}" for change in moved]
        cells += [_spread(_dc(rows, "anew", f"{shift:g}")) for shift in SHIFTS]
        lines.append(f"| {name} | {len(rows)} | {_spread(_dc(rows))} | " + " | ".join(cells) + " |")
    return lines


def _origin_fine(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """The finer lattice shifted by a part of a cell."""
    lines = [
        f"## Lattice of {FINE_MM:g} mm shifted", "",
        f"Each lay at rest at {GRID_MM:g} mm is taken over by the lattice of {FINE_MM:g} mm and settles there, and once more on one that is shifted by a part "
        "of its own cell. DC is to move by at most 1.5 points.", "",
        *_table("fabric", "lays", f"DC at {FINE_MM:g} mm (SD)", *(f"{shift:g}: moved, each lay" for shift in SHIFTS), "kept their nodes"),
    ]  # fmt: skip
    for name, rows in parts["origin-fine"].items():
        cells = [" ".join(f"{change:+.1f}" for change in _dc(rows, "shifted", f"{shift:g}") - _dc(rows, "fine")) for shift in SHIFTS]
        kept = [int((_values(rows, "nodes", "shifted", f"{shift:g}") == _values(rows, "nodes", "fine")).sum()) for shift in SHIFTS]
        lines.append(f"| {name} | {len(rows)} | {_spread(_dc(rows, 'fine'))} | " + " | ".join(cells) + f" | {', '.join(map(str, kept))} |")
    return lines


def _step(parts: Mapping[str, Mapping[str, list[Row]]]) -> list[str]:
    """Smaller time steps, and what true motion does after the end."""
    lines = [
        "## Time step and drift", "",
        f"The same lays with a half and a quarter of the time step, and how DC goes on in {WAITED_S:g} s of true motion after the end.", "",
        *_table("fabric", "lays", "DC (SD)", *(f"dt x {step:g}: moved, each lay" for step in STEPS), "drift, points/s, each lay"),
    ]  # fmt: skip
    for name, rows in parts["step"].items():
        cells = [" ".join(f"{change:+.2f}" for change in _dc(rows, "time_step", f"{step:g}") - _dc(rows)) for step in STEPS]
        drift = " ".join(f"{value:+.3f}" for value in _values(rows, "drift_percent_s"))
        lines.append(f"| {name} | {len(rows)} | {_spread(_dc(rows))} | " + " | ".join(cells) + f" | {drift} |")
    return lines


def main(only: str | None) -> None:
    """Run what has no row yet, write the page."""
    known = sheets()
    materials = {name: sheet_materials(sheet) for name, sheet in known.items()}
    study = run_study(
        "drapemeter", study_cases(known), lambda case: run_case(case, materials[case.fabric]), FOLDER, only=only, say=lambda message: print(message, flush=True)
    )
    write_atomic(FOLDER / "drapemeter.md", page(study.rows))
    for name, message in study.failed.items():
        print(f"refused: {name}: {message}", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
