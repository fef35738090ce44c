"""Sewing closes, keeps momentum at the weld, and refuses a tangled start."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from drawn import pattern, rectangle
from test_dynamics import linear_fabric
from test_lattice import one_material, two_panels

from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.constraints.points import PointRows, rows_where, stitch_rows
from garmentcad.contact.contact import Contact
from garmentcad.errors import TangledError
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.internal import internal_forces
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.pattern.pattern import EdgeUse, Seam
from garmentcad.simulation import sewing
from garmentcad.simulation.course import CLOSED_M, Progress
from garmentcad.simulation.sewing import Welding, as_they_stand, close_seams, closing_leniency, first_orders, row_orders, weld_state
from garmentcad.simulation.start import refuse_tangled
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit

NO_HARDWARE = stitch_rows(np.zeros((0, 2), dtype=np.int32), ())


def test_weld_keeps_mass_center_and_momentum() -> None:
    flat = two_panels()
    welded, particle_map = weld(flat)
    rng = np.random.default_rng(0)
    state = State(rng.standard_normal((flat.particle_count, 3)), rng.standard_normal((flat.particle_count, 3)))
    state.fold_angles = np.array([0.7, -2.0])
    after = weld_state(flat, welded, particle_map, state)
    assert after.fold_angles.tobytes() == state.fold_angles.tobytes()
    for before, now in ((state.positions, after.positions), (state.velocities, after.velocities)):
        assert (welded.masses[:, None] * now).sum(axis=0) == pytest.approx((flat.masses[:, None] * before).sum(axis=0), rel=1e-12)
    alone = np.bincount(particle_map)[particle_map] == 1
    assert after.positions[particle_map[alone]] == pytest.approx(state.positions[alone], rel=1e-14)


def test_start_inside_the_body_or_through_another_panel_is_refused() -> None:
    flat = two_panels()
    body = read_mannequin("woman-88")
    away = np.column_stack([flat.vertex_uv_mm * 1e-3, 2.0 + 0.1 * flat.vertex_panel])
    refuse_tangled(flat, away, body)
    with pytest.raises(TangledError, match=r"points, up to \d+ mm deep, in .*torso.*, \d+ to \d+ mm above the floor.*\); enlarge the offset"):
        refuse_tangled(flat, away + np.array([0.0, 1.0, -2.0]), body)
    crossing = away.copy()
    second = flat.vertex_panel == 1
    # stand the second panel upright on the middle of the first
    middle = crossing[~second].mean(axis=0)
    u, v = (flat.vertex_uv_mm[second] * 1e-3 - (flat.vertex_uv_mm[second] * 1e-3).mean(axis=0)).T
    crossing[second] = middle + np.column_stack([u, np.full_like(u, 1e-4), v])
    with pytest.raises(TangledError, match=" x "):
        refuse_tangled(flat, crossing, body)
    with pytest.raises(TangledError, match=" x "):
        refuse_tangled(flat, crossing, body, flat.panel_names[:1])
    refuse_tangled(flat, crossing, body, flat.panel_names)  # both are worn already: how they hang is no matter of placement
    with pytest.raises(TangledError, match=r"inside mannequin woman-88 \(" + flat.panel_names[0]):
        refuse_tangled(flat, away + np.array([0.0, 1.0, -2.0]), body, flat.panel_names[1:])


def test_a_seam_that_did_not_close_is_said_and_survives_a_checkpoint() -> None:
    welding = Welding({"side": 0.4, "cap": 8.125, "waist": 1.2}, 0.02, ("side", "waist"), {"side": 0.2, "cap": 0.43})
    assert welding.open_seams == [
        "seam 'cap' did not close: it stood 8.1 mm open, widest after 43 % of its length (at most 1 mm is a closed seam)",
        "seam 'waist' did not close: it stood 1.2 mm open (at most 1 mm is a closed seam)",
    ]
    assert welding.conflicting == ["waist"]
    assert Welding.of_run({"phase_from_s": 1.0} | welding.as_run()) == welding
    assert Welding.of_run({}) == Welding()


class Crease(Dynamics):
    """Turns back every stretch of steps that closes less than 3 mm: so do the walls of a crease to what the cloth presses into them."""

    def advance(self, state: State, steps: int) -> None:
        assert self.constraint is not None
        before, gap = state.positions.copy(), np.linalg.norm(self.constraint.gaps(state.positions), axis=1).max()
        super().advance(state, steps)
        left = np.linalg.norm(self.constraint.gaps(state.positions), axis=1).max()
        if left > 1e-4 and gap - left < 3e-3:
            state.positions[:] = before


def test_a_seam_that_is_turned_back_is_pulled_faster_and_faster_until_it_closes() -> None:
    materials = linear_fabric()
    seam = Seam("side", (EdgeUse("front", 1, False),), (EdgeUse("back", 3, True),))
    cloth = build_cloth(pattern(rectangle(60, 60), rectangle(60, 60, name="back"), seams=(seam,)), one_material, materials, 20.0)
    apart = np.column_stack([70.0 * cloth.vertex_panel, np.zeros(cloth.particle_count)])  # edges that meet are 10 mm apart
    positions = np.column_stack([cloth.vertex_uv_mm + apart, np.zeros(cloth.particle_count)]) * 1e-3
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [])
    dynamics = Crease(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials))
    state = State(positions, np.zeros_like(positions), phase="close")
    dynamics.start(state)
    assert close_seams(dynamics, state, NO_HARDWARE, lambda progress: None).open_seams == []
    assert 0.6 < state.time_s < 1.5


def three_squares(height_mm: float = 0.0, apart_mm: float = 10.0) -> tuple[Dynamics, State]:
    """a, b and c in a row, `apart_mm` apart: a is sewn to b, then b to c, which lies `height_mm` higher and 30 mm nearer where that is not 0."""
    materials = linear_fabric()
    seams = tuple(
        Seam(name, (EdgeUse(one, 1, False),), (EdgeUse(other, 3, True),), order=order)
        for name, one, other, order in (("late", "b", "c", 2), ("early", "a", "b", 1))
    )
    cloth = build_cloth(pattern(*(rectangle(60, 60, name=name) for name in "abc"), seams=seams), one_material, materials, 20.0)
    third = (cloth.vertex_panel == 2) * (height_mm != 0.0)
    aside = np.column_stack([(60.0 + apart_mm) * cloth.vertex_panel - 30.0 * third, 0.0 * third])
    positions = 1e-3 * np.column_stack([cloth.vertex_uv_mm + aside, height_mm * third])
    dynamics = Dynamics(
        cloth, ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, []), strain_limit(cloth, materials), Contact(cloth, materials)
    )
    state = State(positions, np.zeros_like(positions), phase="close")
    dynamics.start(state)
    return dynamics, state


def test_an_open_seam_tells_where_it_is_widest() -> None:
    """All stand 10 mm apart; the second stitch of four, a third of the seam from where its sides begin, is besides 30 mm higher on one of them."""
    dynamics, state = three_squares()
    cloth, positions = dynamics.cloth, state.positions.copy()
    begins = np.array([60.0, 20.0])  # side 1 of a square runs up from (60, 0)
    corner = np.flatnonzero((cloth.vertex_panel == 0) & (np.abs(cloth.vertex_uv_mm - begins) < 1e-9).all(axis=1))
    positions[cloth.vertex_particle[corner], 2] += 0.03
    standing = as_they_stand(cloth, positions)
    assert standing.gap_mm == pytest.approx({"late": 10.0, "early": math.hypot(10.0, 30.0)})
    assert standing.widest_at["early"] == pytest.approx(1.0 / 3.0)
    assert as_they_stand(cloth, positions, cloth.stitch_seam == cloth.seam_names.index("late")).gap_mm == pytest.approx({"late": 10.0})


def test_no_stitch_pulls_harder_than_it_may() -> None:
    """Per length of seam: 0.05 N/m are 1 mN for stitches 20 mm apart. Unasked they pull harder."""
    largest = []
    for pull in ({"pull_n_m": 0.05}, {}):
        dynamics, state = three_squares(apart_mm=8.0)
        seen: list[float] = []
        close_seams(
            dynamics,
            state,
            NO_HARDWARE,
            lambda progress, state=state, seen=seen: seen.append(float(np.linalg.norm(state.constraint_forces, axis=1).max())),
            **pull,
        )
        largest.append(max(seen))
    assert largest[0] == pytest.approx(1e-3, rel=1e-9)
    assert largest[1] > 5e-3


def test_seams_of_a_higher_order_wait_until_those_before_them_are_closed() -> None:
    """Three squares in a row: the third lies as it was placed until the first two are one, and these stay so while it comes."""
    dynamics, state = three_squares()
    cloth, positions = dynamics.cloth, state.positions.copy()
    third, seen = cloth.vertex_particle[cloth.vertex_panel == 2], []

    def look(progress: Progress) -> None:
        gaps = np.linalg.norm(state.positions[cloth.stitches[:, 0]] - state.positions[cloth.stitches[:, 1]], axis=1)
        seen.append((np.abs(state.positions - positions)[third].max(), *(gaps[cloth.stitch_seam == seam].max() for seam in (0, 1))))

    welding = close_seams(dynamics, state, NO_HARDWARE, look)
    assert set(welding.gap_mm) == {"late", "early"}
    assert max(welding.gap_mm.values()) < 0.1
    moved, late, early = np.array(seen).T
    waiting = moved < 1e-9
    assert waiting.sum() > 3
    assert late[waiting][-1] > 0.01, "the second seam opens wider while the first one pulls its panel away"
    assert early[waiting][-1] < 1e-4
    assert early[~waiting].max() < 2e-4


@pytest.mark.parametrize(("give_up_mm", "turns"), [(20.0, {1.0, 2.0}), (5.0, {1.0})])
def test_after_a_seam_that_stays_open_the_next_turn_comes_unless_it_is_too_wide(monkeypatch: pytest.MonkeyPatch, give_up_mm: float, turns: set[float]) -> None:
    """With next to no pull none close: they stand open by 10 mm."""
    monkeypatch.setattr(sewing, "CLOSING_CAP_S", 0.1)
    dynamics, state = three_squares()
    seen: set[float] = set()
    welding = close_seams(dynamics, state, NO_HARDWARE, lambda progress: seen.add(state.run["sewing_order"]), 1e-9, give_up_mm=give_up_mm)
    assert seen == turns
    assert "seam 'early' did not close" in welding.open_seams[-1]


def test_sewing_ends_where_a_seam_opens_instead_of_closing() -> None:
    """Squares that fly away from each other, by 83 mm each against the drag of sewing, with next to no pull between them."""
    dynamics, state = three_squares()
    cloth = dynamics.cloth
    left, right = (cloth.vertex_particle[cloth.vertex_panel == panel] for panel in (0, 1))
    state.velocities[left, 2], state.velocities[right, 2] = -1.0, 1.0
    gaps: list[float] = []
    welding = close_seams(dynamics, state, NO_HARDWARE, lambda progress: gaps.append(progress.gap_mm or 0.0), 1e-9, give_up_mm=1.0)
    assert gaps[-1] - min(gaps) > 100.0 > gaps[-2] - min(gaps)
    assert welding.widest_mm == pytest.approx(gaps[-1], rel=1e-12)
    assert state.time_s < 0.5
    assert state.run["sewing_least_m"] == pytest.approx(1e-3 * min(gaps), rel=1e-12), "a run that goes on from here measures from the same gap"


def test_a_panel_that_waits_for_its_seam_is_not_knocked_about() -> None:
    """The third square lies 2 mm over the second one and 20 mm across it, and these rise to meet it: it stays where it is to the last bit, and the second one
    below it."""
    dynamics, state = three_squares(2.0)
    cloth, third, heights = dynamics.cloth, dynamics.cloth.vertex_particle[dynamics.cloth.vertex_panel == 2], []
    state.velocities[cloth.vertex_particle[cloth.vertex_panel != 2], 2] = 0.2
    waiting = state.positions[third].copy()
    below = np.intersect1d(cloth.vertex_particle[cloth.vertex_panel == 1], np.flatnonzero(state.positions[:, 0] > 0.129))  # its seam to the third

    def look(progress: Progress) -> None:
        if state.run["sewing_order"] == 1.0:
            assert state.positions[third].tobytes() == waiting.tobytes()
            heights.append(float(state.positions[below, 2].max()))

    welding = close_seams(dynamics, state, NO_HARDWARE, look)
    assert max(heights) == pytest.approx(1e-3, abs=1e-4), "a gap of 1 mm below"
    assert max(welding.gap_mm.values()) < 0.1
    assert np.linalg.norm(state.positions[third] - waiting, axis=1).min() > 1e-3, "its turn came"
    assert not dynamics.fixed.any()


def test_a_panel_waits_for_the_first_of_its_seams_and_holds_its_buttons_back() -> None:
    dynamics, _ = three_squares()
    cloth = dynamics.cloth
    orders = first_orders(cloth)
    assert [set(orders[cloth.vertex_particle[cloth.vertex_panel == panel]]) for panel in range(3)] == [{1.0}, {1.0}, {2.0}]
    alone = np.array([int(np.argmax(cloth.vertex_panel == panel)) for panel in range(3)])
    rows = PointRows.plain(np.array([0, 1, 1, 2]), np.append(alone, 10**6)[[0, 1, 2, 3]], np.ones(4), np.arange(9.0).reshape(3, 3), ("hook", "button", "body"))
    assert row_orders(rows, orders).tolist() == [1.0, 2.0, 0.0]
    assert row_orders(replace(rows, order=np.array([3.0, 1.0, 0.0])), orders).tolist() == [3.0, 2.0, 0.0]
    kept = rows_where(rows, row_orders(rows, orders) < 2.0)
    assert (kept.names, kept.row.tolist(), kept.particle.tolist()) == (("hook", "body"), [0, 1], [alone[0], 10**6])
    assert kept.targets.tolist() == rows.targets[[0, 2]].tolist()


def test_layers_that_hold_a_seam_apart_are_welded_with_it_late() -> None:
    assert [closing_leniency(time_s) for time_s in (0.0, 1.0, 1.2, 1.4)] == pytest.approx([1.0, 1.0, 2.0, 4.0])
    assert closing_leniency(3.0) * CLOSED_M == pytest.approx(1e-3), "no wider than what is a closed seam"


class Wall(Dynamics):
    """Lets no stitch close, and keeps what each row may ask for."""

    asked: list[tuple[float, np.ndarray]]

    def advance(self, state: State, steps: int) -> None:
        assert self.constraint is not None
        self.asked.append((state.time_s, np.array(self.constraint.least_share)))
        before = state.positions.copy()
        super().advance(state, steps)
        state.positions[:], state.velocities[:] = before, 0.0


def test_only_stitches_of_three_layers_ask_for_more_when_they_are_late() -> None:
    materials = linear_fabric()
    seams = tuple(Seam(name, (EdgeUse(one, 1, False),), (EdgeUse(other, 3, True),)) for name, one, other in (("plain", "a", "b"), ("pleat", "b", "c")))
    cloth = build_cloth(pattern(*(rectangle(60, 60, name=name) for name in "abc"), seams=seams), one_material, materials, 20.0)
    cloth = replace(cloth, seam_layered=np.array([False, True]))
    apart = np.column_stack([70.0 * cloth.vertex_panel, np.zeros(cloth.particle_count)])
    positions = np.column_stack([cloth.vertex_uv_mm + apart, np.zeros(cloth.particle_count)]) * 1e-3
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [])
    dynamics = Wall(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials))
    dynamics.asked = []
    state = State(positions, np.zeros_like(positions), phase="close")
    dynamics.start(state)
    assert len(close_seams(dynamics, state, NO_HARDWARE, lambda progress: None).open_seams) == 2
    layered = cloth.seam_layered[cloth.stitch_seam]
    for time_s, shares in dynamics.asked:
        assert (shares[~layered] == 0.1).all()
        assert shares[layered] == pytest.approx(min(1.0, 0.1 * 2.0 ** max(0.0, (time_s - 1.0) / 0.2)))
    assert max(shares.max() for _, shares in dynamics.asked) == 1.0


def test_what_is_open_late_passes_the_cloth_it_is_sewn_to_and_goes_on_so_from_a_checkpoint() -> None:
    """Two squares whose seam next to nothing closes, one 2 mm over the other: contact sees their stitched ends until 2 s, and not afterwards."""
    materials = linear_fabric()
    seam = Seam("side", (EdgeUse("a", 1, False),), (EdgeUse("b", 3, True),))
    cloth = build_cloth(pattern(*(rectangle(60, 60, name=name) for name in "ab"), seams=(seam,)), one_material, materials, 20.0)
    positions = 1e-3 * (np.column_stack([cloth.vertex_uv_mm, np.zeros(cloth.particle_count)]) + np.outer(cloth.vertex_panel, [50.0, 12.0, 2.0]))

    def stepper() -> Dynamics:
        forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [])
        return Dynamics(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials))

    state, seen, kept = State(positions, np.zeros_like(positions), phase="close"), {}, []

    def look(progress: Progress) -> None:
        nodes = state.contact["pair_nodes"]
        seen[progress.time_s] = bool(np.isin(nodes, cloth.stitches).any())
        if progress.time_s > 2.3 and not kept:
            kept.append(deepcopy(state))

    first = stepper()
    first.start(state)
    close_seams(first, state, NO_HARDWARE, look, 1e-9, 2.6)
    times = np.array(list(seen))
    assert all(seen[time_s] for time_s in times[times < 2.0])
    assert not any(seen[time_s] for time_s in times[times > 2.1])
    close_seams(stepper(), kept[0], NO_HARDWARE, lambda progress: None, 1e-9, 2.6)
    assert np.isin(state.contact["pair_nodes"], cloth.stitches).any(), "it ends with contact as it was"
    assert kept[0].sha256() == state.sha256()
    assert kept[0].contact["pair_nodes"].tobytes() == state.contact["pair_nodes"].tobytes()
