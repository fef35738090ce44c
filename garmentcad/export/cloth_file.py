"""A Cloth in one .npz file without pickle, so that a result folder can be drawn and exported without its spec."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import FileError
from garmentcad.io.atomic import write_atomic
from garmentcad.io.npz_file import read_npz


def write_cloth(path: str | Path, cloth: Cloth) -> Path:
    """Write all arrays; those of the element groups as `group.field`, those of the edges as `edge_vertices.panel.edge`."""
    arrays: dict[str, np.ndarray] = {}
    for field in dataclasses.fields(cloth):
        value = getattr(cloth, field.name)
        if isinstance(value, dict):
            arrays |= {f"{field.name}.{key}": item for key, item in value.items()}
        elif hasattr(value, "_asdict"):
            arrays |= {f"{field.name}.{key}": item for key, item in value._asdict().items()}
        else:
            arrays[field.name] = np.array(value, dtype=np.str_) if isinstance(value, tuple) else np.asarray(value)
    return write_atomic(path, lambda file: np.savez_compressed(file, **arrays))  # type: ignore[arg-type]


def read_cloth(path: str | Path) -> Cloth:
    """Read what `write_cloth` wrote. Raises FileError for a torn or foreign file."""
    arrays = read_npz(path)
    hints = get_type_hints(Cloth)
    values: dict[str, Any] = {}
    try:
        _check(arrays)
        for field in dataclasses.fields(Cloth):
            name, kind = field.name, hints[field.name]
            if hasattr(kind, "_fields"):
                values[name] = kind(**{key: arrays[f"{name}.{key}"] for key in kind._fields})
            elif name == "edge_vertices":
                values[name] = {key.removeprefix("edge_vertices."): item for key, item in arrays.items() if key.startswith("edge_vertices.")}
            elif name in _TEXTS:
                values[name] = tuple(str(item) for item in arrays[name])
            else:
                values[name] = float(arrays[name]) if kind is float else arrays[name]
        return Cloth(**values)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FileError(f"is not a cloth file of this version ({error}); drape the garment again", file=str(path)) from error


_TEXTS = ("panel_names", "seam_names", "fold_names")
# Arrays that point at something: their columns, and at what.
_POINTS_AT = {
    "vertex_panel": ((), "panels"),
    "vertex_particle": ((), "particles"),
    "triangles": ((3,), "vertices"),
    "stitches": ((2,), "particles"),
    "stitch_seam": ((), "seams"),
    "links.ends": ((2,), "particles"),
    "cells.corners": ((4,), "particles"),
    "border.corners": ((3,), "particles"),
    "bends.center": ((), "particles"),
    "bends.arm_a": ((2,), "particles"),
    "bends.arm_b": ((2,), "particles"),
    "spans.corners": ((4,), "particles"),
    "hinges.corners": ((4,), "particles"),
}
_ROWS = dict.fromkeys(("vertex_panel", "vertex_particle", "vertex_on_contour", "vertex_place"), "vertices") | {
    "triangle_material": "triangles",
    "stitch_seam": "stitches",
}


def _check(arrays: dict[str, np.ndarray]) -> None:
    """ValueError for what would draw or measure something else, or nothing: wrong types, shapes, and indices that point outside."""
    counts = {
        "panels": "panel_names",
        "particles": "masses",
        "vertices": "vertex_uv_mm",
        "seams": "seam_names",
        "triangles": "triangles",
        "stitches": "stitches",
    }
    count = {what: len(arrays[name]) for what, name in counts.items()}
    for name, array in arrays.items():
        if array.dtype.kind not in ("U" if name in _TEXTS else "fib") or array.ndim > 2:
            raise ValueError(f"{name} came as {array.dtype} {array.shape}")
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise ValueError(f"{name} is not finite")
        columns, what = ((), "vertices") if name.startswith("edge_vertices.") else _POINTS_AT.get(name, (None, ""))
        if columns is not None:
            if array.dtype.kind != "i" or array.shape[1:] != columns:
                raise ValueError(f"{name} came as {array.dtype} {array.shape}; whole numbers (N, {columns[0] if columns else ''}) are wanted")
            if array.size and (array.min() < 0 or array.max() >= count[what]):
                raise ValueError(f"{name} points outside 0..{count[what] - 1}")
        if name in _ROWS and len(array) != count[_ROWS[name]]:
            raise ValueError(f"{name} has {len(array)} rows for {count[_ROWS[name]]} {_ROWS[name]}")
    if arrays["vertex_uv_mm"].shape[1:] != (2,) or arrays["masses"].ndim != 1 or len(arrays["panel_layer"]) not in (0, count["panels"]):
        raise ValueError("vertex_uv_mm (V,2), masses (P,) and panel_layer (panels,) are wanted")
