"""Elastics and belts on garments: the tension of their laws around a round body, over darts, and cloth that they draw in."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from test_hardware import RADIUS, closed, draped, job

from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.band_lines import band_segments
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation.course import AIR_DRAG
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.record import record
from tools.soak_study import STRAPLESS, job_of


def test_an_elastic_waistband_carries_the_tension_of_its_law() -> None:
    """Around a cylinder with the gap that contact keeps (1 mm and half a sagitta of the grid at least): T = k (2 pi r/L0 - 1), L0 the ratio times the tube.
    The body presses back with 2 pi T in all, which is taken from what it carries, less what the cloth itself is pulled by."""
    stiffness, ratio = 100.0, 0.75
    along = [["left.top.front_top", "left.top.back_top"], ["right.top.back_top", "right.top.front_top"]]
    made = job(closed(elastics=[{"name": "waist", "along": along, "ratio": ratio, "stiffness": stiffness}]))
    outcome = draped(made)
    told, _ = record(outcome)
    assert told.status == "converged"
    half = math.pi * 1000.0 * RADIUS + 2.0
    wanted = stiffness * (2.0 * math.pi * (RADIUS + 1.4e-3) / (ratio * 2e-3 * half) - 1.0)
    assert told.bands["waist"]["tension_n"] == pytest.approx(wanted, rel=0.03)
    assert told.bands["waist"]["max_tension_n"] == pytest.approx(wanted, rel=0.05)
    positions = outcome.state.positions
    outward = positions * [1.0, 0.0, 1.0] / np.linalg.norm(positions[:, [0, 2]], axis=1)[:, None]
    inward = -(outcome.dynamics.net_forces(outcome.state) * outward).sum()
    own = ForceAssembly(internal_forces(outcome.cloth, outcome.materials), outcome.cloth.particle_count)
    cloth = np.zeros_like(positions)
    own.add_up(positions, np.zeros_like(positions), cloth, {name: outcome.state.friction[name].copy() for name in own.slack()})
    assert (inward + (cloth * outward).sum()) / (2.0 * math.pi) == pytest.approx(wanted, rel=0.03)


@pytest.mark.parametrize("at", [0.5, 0.53, 0.56])
def test_an_elastic_goes_over_a_dart(at: float) -> None:
    """Its mouth, 20 mm of the edge, is no part of what the elastic is sewn to."""
    along = [["left.top.front_top", "left.top.back_top"]]

    def darted(data: dict[str, Any]) -> None:
        closed(elastics=[{"name": "waist", "along": along, "ratio": 0.8, "stiffness": 10.0}])(data)
        data["panels"]["left"]["darts"] = [{"name": "dart", "edge": "top", "at": at, "intake": 20, "length": 60}]

    made = job(darted)
    materials, material_of = lay_out(made)
    cloth, _ = weld(build_cloth(made.pattern, material_of, materials, made.grid_mm))
    flat_m = math.pi * RADIUS + 2e-3 - 20e-3
    assert band_segments(made.pattern, cloth).rest.sum() == pytest.approx(0.8 * flat_m, rel=2e-3)


@pytest.mark.parametrize("kind", ["elastics", "belts"])
def test_what_a_band_draws_in_folds_and_is_not_squeezed(kind: str) -> None:
    """A tube 40 % wider than its cylinder: bands through every particle squeezed its upper edge, and stretched the row below by 4 to 6 %."""
    along = [["left.top.front_top", "left.top.back_top"], ["right.top.back_top", "right.top.front_top"]]
    length = {"elastics": {"ratio": 0.62, "stiffness": 40.0}, "belts": {"length": 0.87 * 2000.0 * math.pi * RADIUS, "stiffness": 80.0}}[kind]

    def wide(data: dict[str, Any]) -> None:
        closed(**{kind: [{"name": "waist", "along": along, **length}]})(data)
        data["values"]["half"] = "1.4 * waist / 2"

    outcome = draped(job(wide))
    told, _ = record(outcome)
    assert told.status == "converged"
    assert told.bands["waist"]["length_mm"] == pytest.approx(2000.0 * math.pi * RADIUS, rel=0.06)
    first, second = outcome.state.positions[outcome.cloth.links.ends].transpose(1, 0, 2)
    stretched = np.linalg.norm(second - first, axis=1) / outcome.cloth.links.rest_length
    assert stretched.min() > 0.98
    assert stretched.max() < 1.02
    cloth = outcome.cloth
    edge = cloth.edge_vertices["left.top"]
    drawn = np.linalg.norm(np.diff(outcome.state.positions[cloth.vertex_particle[edge]], axis=0), axis=1)
    assert (drawn / (1e-3 * np.linalg.norm(np.diff(cloth.vertex_uv_mm[edge], axis=0), axis=1))).min() > 0.95


def test_a_belt_has_one_tension_all_around() -> None:
    length, stiffness = 690.0, 2000.0
    along = [["left.belt_front", "left.belt_back"], ["right.belt_back", "right.belt_front"]]
    outcome = draped(job(closed(belts=[{"name": "belt", "along": along, "length": length, "stiffness": stiffness}])))
    told, _ = record(outcome)
    assert told.status == "converged"
    assert told.bands["belt"]["tension_n"] == pytest.approx(told.bands["belt"]["max_tension_n"], rel=1e-12)  # a mean of equal numbers, and one of them
    assert told.bands["belt"]["tension_n"] == pytest.approx(stiffness * (2000.0 * math.pi * (RADIUS + 1.4e-3) / length - 1.0), rel=0.03)


def test_what_an_elastic_gathers_is_at_rest_in_true_motion() -> None:
    """A strapless top as its soak has it: while the watch let no force make cloth faster than 1 m/s, an elastic held folds that gave way by 40 mm after it."""
    outcome = draped(job_of(STRAPLESS, "cotton-shirting"))
    assert outcome.status == "converged"
    dynamics, state, home = outcome.dynamics, outcome.state, outcome.state.positions.copy()
    dynamics.drag, dynamics.speed_cap_m_s = AIR_DRAG, math.inf
    dynamics.advance(state, 2000)
    assert np.linalg.norm(state.positions - home, axis=1).max() < 0.5e-3
