"""All virtual Kawabata testers in one place: what they record of a fabric and what they print, by the keys of the sheet."""

from __future__ import annotations

from typing import NamedTuple

from garmentcad.fabric.material import MaterialTable, material_row, material_table, without_friction
from garmentcad.fabric.sheet import KesSheet
from garmentcad.rigs.bending import bending_test, printed_bending
from garmentcad.rigs.equilibrium import UnbalancedError
from garmentcad.rigs.loop import Branch
from garmentcad.rigs.shear import printed_shear, shear_test
from garmentcad.rigs.specimen import ANGLES
from garmentcad.rigs.tension import printed_tension, tension_test


class KesTester(NamedTuple):
    """A test of one kind on a specimen cut in one way."""

    kind: str  # tension, shear or bending
    way: str  # warp, weft or bias

    @property
    def name(self) -> str:
        return f"{self.kind} {self.way}"


class Record(NamedTuple):
    """branches: what was recorded, in order; printed: what is read from it, by the keys of the sheet."""

    branches: tuple[Branch, ...]
    printed: dict[str, float]


TESTERS = (*(KesTester(kind, way) for kind in ("tension", "shear") for way in ("warp", "weft")), *(KesTester("bending", way) for way in ANGLES))


def run_tester(tester: KesTester, sheet: KesSheet, materials: MaterialTable, grid_mm: float, shift: float = 0.0, sides: int = 2) -> Record:
    """One test of the fabric in row 0 of `materials`; Fm and the window of G are those of the sheet. shift: of the lattice, in spacings. sides: to which shear
    and bending go; virtual cloth has the same behaviour on both, so that 1 is enough where nobody wants to see the loop. UnbalancedError names the tester."""
    try:
        return _run_tester(tester, sheet, materials, grid_mm, shift, sides)
    except UnbalancedError as error:
        raise UnbalancedError(f"{tester.name}: {error}") from None


def _run_tester(tester: KesTester, sheet: KesSheet, materials: MaterialTable, grid_mm: float, shift: float, sides: int) -> Record:
    angle = ANGLES[tester.way]
    origin = (shift * grid_mm, shift * grid_mm) if shift else None
    branches: tuple[Branch, ...]
    if tester.kind == "tension":
        branches = tension_test(materials, angle, grid_mm, sheet.number("Fm"), origin)
        printed = printed_tension(*branches)
    elif tester.kind == "shear":
        loop = shear_test(materials, angle, grid_mm, origin, sides)
        branches, printed = loop.branches(), printed_shear(loop, sheet.shear_window_deg)
    else:
        # Off the grain the lattice resolves curvatures at which internal friction still holds: what the tester prints there is B of the elastic fabric.
        off_grain = tester.way == "bias"
        loop = bending_test(without_friction(materials) if off_grain else materials, angle, grid_mm, shift, sides)
        branches, printed = loop.branches(), printed_bending(loop)
        if off_grain:
            del printed["2HB"]
    return Record(branches, {f"{name}.{tester.way}": value for name, value in printed.items()})


def sheet_materials(sheet: KesSheet) -> MaterialTable:
    """The material table of a completed sheet alone; law values where it carries them."""
    return material_table([material_row(sheet)])
