"""The folder `movement` of a result: frames of a garment on a body that moves, each of them judged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad.analysis.carried import slip_mm
from garmentcad.analysis.contact_faults import contact_faults
from garmentcad.cloth.cloth import Cloth
from garmentcad.export.picture import ViewMissing, write_picture
from garmentcad.export.side_by_side import Exhibit, draw_side_by_side
from garmentcad.io.atomic import write_atomic
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern, edge_roles
from garmentcad.simulation.movement import Movement

_SHOWN = 6  # frames in the picture
_PICTURE_PX = 700
_DIGITS = 6
_MEASURED = ("self_intersections", "mannequin_intersections", "mannequin_penetration_mm", "waist_slip_mm")


def movement_report(movement: Movement, cloth: Cloth, mannequin: Mannequin, pattern: Pattern) -> dict[str, Any]:
    """What `report.json` says under `movement`: largest values over all frames, and a row a frame.

    status: moved (to the end, every frame clean), intersecting (penetration included), diverged, or fell. seconds: simulated; wall_time_s: what that took.
    warning: where the first frame that is not clean crosses, and why it broke off. self_intersections, mannequin_intersections: triangle pairs.
    waist_slip_mm: how far edges with the role `waist` came down on the body since the first frame, None without such edges.
    Of a frame that is not finite, at which the movement diverged, nothing is measured: all None.
    """
    slips = slip_mm(cloth, movement.positions, movement.body, edge_roles(pattern))
    rows: list[dict[str, Any]] = []
    status, warning, crossed = movement.status, movement.warning, ""
    for k, (time_s, positions, body) in enumerate(zip(movement.times_s, movement.positions, movement.body, strict=True)):
        row = {"time_s": round(float(time_s), _DIGITS), **dict.fromkeys(_MEASURED)}
        rows.append(row)
        if not np.isfinite(positions).all():
            continue
        faults = contact_faults(cloth, positions, mannequin, body)
        slip = None if slips is None else round(float(slips[k]), _DIGITS)
        values = (faults.self_intersections, faults.mannequin_intersections, round(faults.mannequin_penetration_mm, _DIGITS), slip)
        row |= zip(_MEASURED, values, strict=True)
        if faults and not crossed:
            crossed = f"after {time_s:.2f} s of the movement {'; '.join(faults.said)}"
    if crossed:
        status, warning = ("intersecting", crossed) if status == "moved" else (status, f"{crossed}; {warning}")
    worst = {key: max((row[key] for row in rows if row[key] is not None), default=None) for key in _MEASURED}
    return {"status": status, "seconds": rows[-1]["time_s"], "wall_time_s": movement.wall_s, "warning": warning, **worst, "frames": rows}


def write_movement(folder: Path, movement: Movement, cloth: Cloth, mannequin: Mannequin) -> tuple[list[Path], list[str]]:
    """frames.npz (times_s (K,), positions (K,P,3) and body (K,V,3) m) and, with the extra `view`, a picture; the files, and notes on what was left out."""
    folder.mkdir(parents=True, exist_ok=True)
    arrays = {"times_s": movement.times_s, "positions": movement.positions.astype(np.float32), "body": movement.body.astype(np.float32)}
    files = [write_atomic(folder / "frames.npz", lambda file: np.savez_compressed(file, **arrays))]  # type: ignore[arg-type]
    finite = np.flatnonzero(np.isfinite(movement.positions).all(axis=(1, 2)))
    chosen = finite[np.unique(np.linspace(0, len(finite) - 1, _SHOWN).round().astype(int))]
    exhibits = [Exhibit(f"{movement.times_s[k]:.2f} s", movement.positions[k], cloth, replace(mannequin, vertices=movement.body[k]), None) for k in chosen]
    try:
        files.append(write_picture(folder / "frames.png", draw_side_by_side(exhibits, ("three-quarter",), _PICTURE_PX)))
    except ViewMissing as missing:
        return files, [f"no picture of the movement: {missing}"]
    return files, []
