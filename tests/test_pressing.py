"""A crease in suiting: pressed it keeps most of its angle while it hangs, folded by hand only it opens; a pressed knife pleat stays folded."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from garmentcad.analysis.folds import fold_angles_deg
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import without_friction
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.shipped import shipped_file
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.simulation.job import Job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.pressing import imposed_angles, press, shares, under_iron
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit

NOBODY = Mannequin("none", np.zeros((0, 3)), np.zeros((0, 3), np.int32), {}, {}, {}, (), np.zeros(0, np.int32))
HANG_S = 1.5


def job(width: float, height: float = 60.0, **more: Any) -> Job:
    """A swatch in wool suiting, warp upright."""
    drawn = {
        "points": {"a": [0, 0], "b": [width, 0], "c": [width, height], "d": [0, height]},
        "edges": [{"name": f"e_{name}", "from": name, "to": after} for name, after in zip("abcd", "bcda")],
        "internal_lines": {"middle": [[width / 2, 0], [width / 2, height]], "outer": [[45, 0], [45, height]], "inner": [[95, 0], [95, height]]},
        "placement": {"transform": {"translation": [0, 0, 0]}},
        **more,
    }
    spec = parse_spec({"name": "x", "fabric": "wool-suiting", "mannequin": "woman-88", "panels": {"p": drawn}}, "x.yaml")
    return Job(spec, draft(spec, {}), {"wool-suiting": load_fabric(shipped_file("fabrics", "wool-suiting"))}, NOBODY)


def pressed_and_hung(made: Job, top_mm: float | None = None) -> tuple[Cloth, list[dict[str, float | None]], State]:
    """Angles under the iron and after hanging, and the State at the end. It hangs by both ends of the first fold, which is upright, or by all that is higher
    than `top_mm`, which stays folded."""
    materials, material_of = lay_out(made)
    cloth = build_cloth(made.pattern, material_of, materials, 10.0)
    positions = np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(cloth.particle_count)])
    positions += 1e-5 * np.random.default_rng(0).standard_normal(positions.shape)
    state = State(positions, np.zeros_like(positions), phase="press", run={"phase_from_s": 0.0}, fold_angles=np.zeros(len(cloth.fold_names)))
    panel = made.pattern.panels["p"]
    lines = {f"p.{fold.name}": fold.points_mm for fold in panel.folds}

    def dynamics_of(piece: Cloth, angles: np.ndarray, weight: bool, fixed: np.ndarray | None = None) -> Dynamics:
        forces = internal_forces(piece, materials if weight else without_friction(materials), fold_angles=angles)
        assembly = ForceAssembly(forces, piece.particle_count, [ForceGravity(piece.masses)] if weight else [])
        return Dynamics(piece, assembly, strain_limit(piece, materials), Contact(piece, materials), fixed)

    iron = dynamics_of(under_iron(cloth), imposed_angles(made), weight=False)
    iron.start(state)
    press(iron, state, made, lambda progress: None)
    found = [fold_angles_deg(cloth, state.positions, lines)]
    by_ends = np.any([np.linalg.norm(cloth.vertex_uv_mm - end, axis=1) < 6.0 for end in panel.folds[0].points_mm], axis=0)
    fixed = by_ends if top_mm is None else cloth.vertex_uv_mm[:, 1] > top_mm
    hung = State(state.positions, np.zeros_like(positions), phase="fall", friction=state.friction, fold_angles=state.fold_angles)
    dynamics = dynamics_of(cloth, state.fold_angles, True, fixed)
    dynamics.equalise, dynamics.drag = True, 5.0
    dynamics.start(hung)
    while hung.time_s < HANG_S:
        dynamics.advance(hung, 96)
    found.append(fold_angles_deg(cloth, hung.positions, lines))
    return cloth, found, hung


def test_a_pressed_crease_stays_and_one_that_is_not_opens() -> None:
    # wings of 35 mm: wider ones sag and swing toward each other
    kept = {}
    for pressed in (True, False):
        made = job(70, folds=[{"name": "crease", "line": "middle", "angle": -150, "pressed": pressed}])
        _, (ironed, hung), state = pressed_and_hung(made)
        assert ironed["p.crease"] == pytest.approx(-150.0, abs=8.0)
        assert np.degrees(state.fold_angles) == pytest.approx([-127.5 if pressed else 0.0])
        kept[pressed] = hung["p.crease"] / -150.0
    assert 0.60 < kept[True] < 0.95
    assert abs(kept[False]) < 0.2


def test_a_pressed_knife_pleat_stays_folded() -> None:
    """Sewn up at its top, as under a yoke, and hanging from there."""
    folds = [{"name": "outer", "line": "outer", "angle": -140}, {"name": "under", "line": "inner", "angle": 140}]
    kept = {}
    for pressed in (True, False):
        made = job(140, 120.0, folds=[{**fold, "pressed": pressed} for fold in folds])
        assert shares(made) == pytest.approx([0.85, 0.85] if pressed else [0.0, 0.0])
        _, (ironed, hung), state = pressed_and_hung(made, top_mm=114.0)
        assert ironed["p.outer"] == pytest.approx(-140.0, abs=12.0)
        assert ironed["p.under"] == pytest.approx(140.0, abs=12.0)
        assert np.degrees(state.fold_angles) == pytest.approx([-119.0, 119.0] if pressed else [0.0, 0.0])
        kept[pressed] = hung["p.outer"] / -140.0, hung["p.under"] / 140.0
    for share in kept[True]:
        assert 0.60 < share < 0.95
    for share in kept[False]:
        assert share < 0.3
