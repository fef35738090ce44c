"""The internal forces of a cloth, with internal damping set by rule."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.border import ForceBorder
from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.hinge import ForceHinge
from garmentcad.forces.lattice import ForceLattice, contour_lines
from garmentcad.forces.span import ForceSpan
from garmentcad.forces.time_step import DAMPING_RATIO, internal_damping_time


def internal_forces(cloth: Cloth, materials: MaterialTable, damping_ratio: float = DAMPING_RATIO) -> list[Force]:
    """Lattice (stretch, shear, twist, bend), border, bend lines that end on the contour, contour spans and seam hinges of `cloth`, those that have elements.

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
    forces: list[Force] = [*damped, contour_lines(cloth, materials), ForceSpan(cloth, materials), ForceHinge(cloth, materials)]
    return [force for force in forces if (force.corners != NO_PARTICLE).any()]
