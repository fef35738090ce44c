"""garmentcad: garments from sewn patterns and measured fabrics, draped on mannequins, with numbers one can assert.

    import garmentcad as gc
    result = gc.drape(gc.read_spec("flared-skirt"), fabric="wool-suiting")

Names are loaded when first used, so that `import garmentcad` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "GarmentError": "garmentcad.errors",
    "InputError": "garmentcad.errors",
    "GarmentSpec": "garmentcad.pattern.spec",
    "Pattern": "garmentcad.pattern.pattern",
    "draft": "garmentcad.pattern.draft",
    "read_spec": "garmentcad.io.spec_file",
    "write_spec": "garmentcad.io.spec_file",
    "KesSheet": "garmentcad.fabric.sheet",
    "KesValue": "garmentcad.fabric.sheet",
    "read_fabric": "garmentcad.io.fabric_file",
    "write_fabric": "garmentcad.io.fabric_file",
    "Mannequin": "garmentcad.mannequin.mannequin",
    "read_mannequin": "garmentcad.io.mannequin_file",
    "build_cloth": "garmentcad.cloth.lattice",
    "weld": "garmentcad.cloth.weld",
    "examine": "garmentcad.check.examine",
    "Job": "garmentcad.simulation.job",
    "make_job": "garmentcad.simulation.job",
    "drape": "garmentcad.export.drape",
}

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'garmentcad' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
