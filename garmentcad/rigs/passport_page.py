"""The passport as one HTML page that needs nothing beside it: tables, curves and the shadow as SVG."""

from __future__ import annotations

import html
from pathlib import Path

import numpy as np

from garmentcad.fabric.quantity import quantity_of
from garmentcad.io.atomic import write_atomic
from garmentcad.rigs.cusick import GEOMETRIES
from garmentcad.rigs.loop import Branch
from garmentcad.rigs.passport import Passport
from garmentcad.rigs.sheet_curves import sheet_curves

_AXES = {"tension": ("strain, %", "force, gf/cm"), "shear": ("angle, degrees", "force, gf/cm"), "bending": ("curvature, 1/cm", "moment, gf.cm/cm")}
_WIDTH, _HEIGHT, _EDGE = 340, 240, 44
_STYLE = """body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}td:first-child,th:first-child{text-align:left}
figure{display:inline-block;margin:.5em}figcaption{text-align:center}svg{background:#fafafa}.sheet{stroke:#bbb;stroke-width:5;fill:none}.record{stroke:#b03030;stroke-width:1.5;fill:none}
.axis{stroke:#888;fill:none}text{font-size:11px;fill:#444}.shadow{fill:#556;fill-rule:evenodd}.disc{fill:none;stroke:#c80}"""


def write_page(path: str | Path, passport: Passport) -> Path:
    """Write the page."""
    figures = passport.figures
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(passport.sheet.name)}</title><style>{_STYLE}</style>",
        f"<h1>{html.escape(passport.sheet.name)}</h1><p>{html.escape(passport.sheet.description)}</p>",
        f"<p>Measured share of the sheet {100.0 * figures['measured_fraction']:.0f} %. Tested at {figures['grid_mm']:g} mm.</p>",
        _kes_table(passport),
    ]
    for tester, record in passport.records.items():
        reference = sheet_curves(passport.sheet, tester, float(np.abs(record.branches[0].x).max()))
        parts.append(f"<figure>{_plot(reference, record.branches, *_AXES[tester.kind])}<figcaption>{tester.name}</figcaption></figure>")
    parts.append("<p>Grey: what the sheet says, friction fully drawn on each way; red: recorded by the virtual tester.</p>")
    parts.append(_cantilever(passport))
    if passport.drapes:
        parts.append(_drape(passport))
    return write_atomic(path, "\n".join(parts) + "\n</html>\n")


def _kes_table(passport: Passport) -> str:
    law, sheet = passport.figures["law"], passport.sheet
    rows = ["<table><tr><th>value<th>unit<th>sheet<th>virtual tester<th>error, %<th>law, % of sheet<th>from</tr>"]
    for key, row in passport.figures["kes"].items():
        given = "-" if row["input"] is None else f"{row['input']:.4g}"
        error = "-" if row["error_percent"] is None else f"{row['error_percent']:+.2f}"
        correction = law["corrections_percent"].get(key) if law else None
        origin = html.escape(sheet.origin(key)) if row["input"] is not None else "-"
        shown = "-" if correction is None else f"{correction:+.2f}"
        rows.append(f"<tr><td>{key}<td>{quantity_of(key).unit}<td>{given}<td>{row['simulated']:.4g}<td>{error}<td>{shown}<td>{origin}</tr>")
    return "\n".join([*rows, "</table>"])


def _plot(reference: tuple[Branch, ...], record: tuple[Branch, ...], x_name: str, y_name: str) -> str:
    x, y = (np.concatenate([getattr(branch, name) for branch in (*reference, *record)]) for name in ("x", "y"))
    left, right, low, high = min(x.min(), 0.0), x.max(), min(y.min(), 0.0), y.max()

    def line(branch: Branch, kind: str) -> str:
        px = _EDGE + (branch.x - left) / (right - left) * (_WIDTH - 2 * _EDGE)
        py = _HEIGHT - _EDGE - (branch.y - low) / (high - low) * (_HEIGHT - 2 * _EDGE)
        return f'<polyline class={kind} points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px, py))}"/>'

    axes = [Branch(np.array([left, right]), np.zeros(2)), Branch(np.zeros(2), np.array([low, high]))]
    lines = [line(axis, "axis") for axis in axes] + [line(branch, "sheet") for branch in reference] + [line(branch, "record") for branch in record]
    words = f"<text x={_WIDTH // 2} y={_HEIGHT - 12} text-anchor=middle>{x_name} ({left:.3g} to {right:.3g})</text>"
    words += f"<text x=6 y=16>{y_name} ({low:.3g} to {high:.3g})</text>"
    return f"<svg width={_WIDTH} height={_HEIGHT}>{''.join(lines)}{words}</svg>"


def _cantilever(passport: Passport) -> str:
    figures = passport.figures["cantilever"]
    said = "; ".join(
        f"{way} {figures[way]['bending_length_mm']:.1f} mm ({figures[way]['overhang_mm']:.1f} mm hang over; B alone, without friction, gives "
        f"{figures[way]['without_friction_mm']:.1f} mm)"
        for way in ("warp", "weft")
    )
    return f"<h2>Cantilever (ASTM D1388), {figures['chord_deg']:g} degrees</h2><p>Bending length: {said}.</p>"


def _drape(passport: Passport) -> str:
    figures = passport.figures["drape"]
    disc, specimen = GEOMETRIES[figures["geometry_cm"]]
    spread = "" if figures["dc_percent"]["sd"] is None else f" (SD {figures['dc_percent']['sd']:.1f})"
    said = (
        f"<h2>Drapemeter {figures['geometry_cm']} cm</h2><p>Drape coefficient {figures['dc_percent']['mean']:.1f} %{spread} over {len(passport.drapes)} lays, "
        f"nodes {figures['nodes']['mean']:.1f}, rim {figures['rim_min_mm']:.0f} to {figures['rim_max_mm']:.0f} mm, lowest point {figures['lowest_mm']:.0f} mm "
        "below the disc.</p>"
    )
    if not passport.converged:
        said += f"<p>Not every lay came to rest: {', '.join(figures['status'])}.</p>"
    half = 0.55 * specimen
    pictures = []
    for number, drape in enumerate(passport.drapes, start=1):
        path = " ".join("M" + " L".join(f"{x:.1f},{z:.1f}" for x, z in ring) + "Z" for ring in drape.shadow.outline_mm)
        circles = f"<circle class=disc r={0.5 * disc} /><circle class=axis r={0.5 * specimen} stroke-dasharray=4 />"
        picture = f'<svg width=200 height=200 viewBox="{-half} {-half} {2 * half} {2 * half}"><path class=shadow d="{path}"/>{circles}</svg>'
        pictures.append(f"<figure>{picture}<figcaption>lay {number}: {drape.dc_percent:.1f} %, {drape.shadow.nodes} nodes</figcaption></figure>")
    return said + "".join(pictures)
