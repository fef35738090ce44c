"""garmentcad: garments from sewn patterns and measured fabrics, draped on mannequins, with numbers one can assert.

    import garmentcad as gc
    result = gc.drape(gc.read_spec("flared-skirt"), fabric="wool-suiting")

Names are loaded when first used, so that `import garmentcad` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # for type checkers and editors, which do not run `__getattr__`
    from garmentcad.check.examine import examine as examine
    from garmentcad.cloth.lattice import build_cloth as build_cloth
    from garmentcad.cloth.weld import weld as weld
    from garmentcad.errors import GarmentError as GarmentError
    from garmentcad.errors import InputError as InputError
    from garmentcad.export.drape import drape as drape
    from garmentcad.fabric.sheet import KesSheet as KesSheet
    from garmentcad.fabric.sheet import KesValue as KesValue
    from garmentcad.io.fabric_file import read_fabric as read_fabric
    from garmentcad.io.fabric_file import write_fabric as write_fabric
    from garmentcad.io.mannequin_file import read_mannequin as read_mannequin
    from garmentcad.io.spec_file import read_spec as read_spec
    from garmentcad.io.spec_file import write_spec as write_spec
    from garmentcad.mannequin.mannequin import Mannequin as Mannequin
    from garmentcad.pattern.draft import draft as draft
    from garmentcad.pattern.pattern import Pattern as Pattern
    from garmentcad.pattern.spec import GarmentSpec as GarmentSpec
    from garmentcad.simulation.job import Job as Job
    from garmentcad.simulation.job import make_job as make_job

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
