"""The internal forces of a cloth, with internal damping set by rule."""

from __future__ import annotations

from typing import Any

import numpy as np

from garmentcad.arrays import kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import write_bend
from garmentcad.forces.border import ForceBorder, write_border
from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.hinge import ForceHinge, write_hinge
from garmentcad.forces.lattice import ForceLattice, contour_lines, write_lattice
from garmentcad.forces.span import ForceSpan, write_span
from garmentcad.forces.time_step import DAMPING_RATIO, internal_damping_time

LAWS = ("lattice", "border", "bend", "span", "hinge")


@kernel
def write_internal(laws, positions, velocities, corner_forces):  # type: ignore[no-untyped-def]
    """All corner forces. laws: see `law_arguments`."""
    first, lattice, border, bend, span, hinge = laws
    write_lattice(lattice[0], lattice[1], lattice[2], lattice[3], positions, velocities, corner_forces[first[0] : first[1]])
    if first[2] > first[1]:
        write_border(border[0], border[1], positions, velocities, corner_forces[first[1] : first[2]])
    if first[3] > first[2]:
        write_bend(bend[0], positions, velocities, corner_forces[first[2] : first[3]])
    if first[4] > first[3]:
        write_span(span[0], positions, velocities, corner_forces[first[3] : first[4]])
    if first[5] > first[4]:
        write_hinge(hinge[0], positions, velocities, corner_forces[first[4] : first[5]])


def law_arguments(forces: tuple[Any, ...]) -> tuple[Any, ...]:
    """Arguments of `write_internal` for the forces of `internal_forces`: where the corners of each begin, and what each compiled law needs."""
    if tuple(force.name for force in forces) != LAWS:
        raise ValueError(f"forces {[force.name for force in forces]}; the stepper knows {list(LAWS)}, in this order")
    return np.cumsum([0, *(len(force.corners) for force in forces)]), *(force.arguments for force in forces)


def internal_forces(cloth: Cloth, materials: MaterialTable, damping_ratio: float = DAMPING_RATIO) -> list[Force]:
    """Lattice (stretch, shear, twist, bend), border, bend lines that end on the contour, contour spans and seam hinges of `cloth`.

    Damping acts along the strain rates of stretch, shear and border with one time tau, so that the highest in-plane mode at rest, the stiffest of the cloth,
    has about `damping_ratio` (0 for none); lower modes have less in proportion to their frequency. Rigid motion is not damped.
    """
    damped: list[ForceLattice | ForceBorder] = [ForceLattice(cloth, materials), ForceBorder(cloth, materials)]
    stiffness = np.zeros(cloth.particle_count)
    for force in damped:
        corner_stiffness = np.empty(len(force.corners))
        force.write_rest_stiffness(corner_stiffness)
        used = force.corners != NO_PARTICLE
        stiffness += np.bincount(force.corners[used], weights=corner_stiffness[used], minlength=len(stiffness))
    for force in damped:
        force.damping_time = internal_damping_time(stiffness, cloth.masses, damping_ratio)
    return [*damped, contour_lines(cloth, materials), ForceSpan(cloth, materials), ForceHinge(cloth, materials)]
