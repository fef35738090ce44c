"""Coulomb friction with true sticking: the incline, on a body and on cloth."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from loose_sheet import Sheet, correct, fabric

from garmentcad.contact.contact import Contact

DT = 1.5e-4
MU = 0.35
SLIP = np.degrees(np.arctan(MU))


def tilted(degrees: float) -> np.ndarray:
    angle = np.radians(degrees)
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])


def slide_on_body(degrees: float, steps: int) -> tuple[np.ndarray, float]:
    """Way down the slope per particle after the first 20 steps (m), and work of friction (J)."""
    turn = tilted(degrees)
    box = trimesh.creation.box(extents=(0.5, 0.1, 0.5)).subdivide().subdivide()
    sheet = Sheet(4)
    contact = Contact(sheet.cloth, fabric(MU), (box.vertices @ turn.T, box.faces), itself=False)
    state = sheet.state(sheet.at(0, 0.05 + 1e-3, 0) @ turn.T)
    contact.start(state)
    for step in range(steps + 20):
        if step == 20:
            start = state.positions.copy()
        sheet.pull(state, DT, drag=0.0)
        correct(state, DT, contact)
        state.positions += DT * state.velocities
    return (start - state.positions) @ turn[:, 0], state.work_j["friction"]


def test_sheet_on_a_body_sticks_below_the_angle_of_friction() -> None:
    way, _ = slide_on_body(SLIP - 0.25, 1000)
    assert np.abs(way).max() < 1e-9


def test_sheet_on_a_body_slides_above_it_as_coulomb_says() -> None:
    degrees, steps = SLIP + 0.25, 1000
    way, work = slide_on_body(degrees, steps)
    angle = np.radians(degrees)
    pull = 9.81 * (np.sin(angle) - MU * np.cos(angle))
    sheet_mass = Sheet(4).cloth.masses.sum()
    total = 0.5 * pull * ((steps + 20) * DT) ** 2
    assert way.mean() == pytest.approx(total - 0.5 * pull * (20 * DT) ** 2, rel=0.02)
    assert np.ptp(way) < 1e-6
    assert work == pytest.approx(-MU * sheet_mass * 9.81 * np.cos(angle) * total, rel=0.005)


@pytest.mark.parametrize(("offset", "sticks"), [(-0.25, True), (0.25, False)])
def test_sheet_on_a_held_sheet(offset: float, sticks: bool) -> None:
    turn = tilted(SLIP + offset)
    sheet = Sheet(6, panels=2)
    cloth, count = sheet.cloth, 49
    positions = np.tile(sheet.positions[:count] - sheet.positions[:count].mean(axis=0), (2, 1))
    positions[count:] *= 0.61  # the upper sheet is smaller, so that its particles stand inside the lower one's triangles
    sheet.rest_length[sheet.ends.min(axis=1) >= count] *= 0.61
    positions[count:] += [0.0013, 1e-3, 0.0017]
    held = np.arange(2 * count) < count
    inverse = np.where(held, 0.0, 1.0 / cloth.masses)
    contact = Contact(cloth, fabric(MU), inverse_masses=inverse)
    state = sheet.state(positions @ turn.T)
    contact.start(state)
    steps = 400
    for step in range(steps + 20):
        if step == 20:
            start = state.positions.copy()
        sheet.pull(state, DT, drag=0.0)
        state.velocities[held] = 0.0
        correct(state, DT, contact)
        state.positions += DT * state.velocities
    way = ((start - state.positions) @ turn[:, 0])[count:]
    angle = np.radians(SLIP + offset)
    slid = 0.5 * 9.81 * (np.sin(angle) - MU * np.cos(angle)) * (((steps + 20) * DT) ** 2 - (20 * DT) ** 2)
    if sticks:
        assert np.abs(way).max() < 1e-8  # what the sweeps leave in 0.06 s
    else:
        assert way.mean() == pytest.approx(slid, rel=0.1)
