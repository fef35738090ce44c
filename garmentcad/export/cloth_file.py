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
        for field in dataclasses.fields(Cloth):
            name, kind = field.name, hints[field.name]
            if hasattr(kind, "_fields"):
                values[name] = kind(**{key: arrays[f"{name}.{key}"] for key in kind._fields})
            elif name == "edge_vertices":
                values[name] = {key.removeprefix("edge_vertices."): item for key, item in arrays.items() if key.startswith("edge_vertices.")}
            elif name in ("panel_names", "seam_names"):
                values[name] = tuple(str(item) for item in arrays[name])
            else:
                values[name] = float(arrays[name]) if kind is float else arrays[name]
        cloth = Cloth(**values)
        _check(cloth)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FileError(f"is not a cloth file of this version ({error}); drape the garment again", file=str(path)) from error
    return cloth


def _check(cloth: Cloth) -> None:
    vertices, particles = len(cloth.vertex_uv_mm), cloth.particle_count
    for what, array, count in (
        ("triangles", cloth.triangles, vertices),
        ("vertex_particle", cloth.vertex_particle, particles),
        ("vertex_panel", cloth.vertex_panel, len(cloth.panel_names)),
    ):
        if array.size and (array.min() < 0 or array.max() >= count):
            raise ValueError(f"{what} points outside 0..{count - 1}")
