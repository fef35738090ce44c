"""The stepper of a job: its forces, contact and strain limit on one cloth, for sewing and pressing or for what comes after."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.contact.contact import Contact
from garmentcad.contact.path import BodyPath
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.band import ForceBand
from garmentcad.forces.band_lines import band_segments
from garmentcad.forces.button import ForceButton
from garmentcad.forces.force import Force
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces, soften
from garmentcad.simulation.course import SOFTNESS
from garmentcad.simulation.job import Job
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.hardware import button_shanks
from garmentcad.solve.strain_limit import strain_limit


def make_dynamics(
    job: Job, cloth: Cloth, materials: MaterialTable, fold_angles: np.ndarray, dressing: bool = False, path: BodyPath | None = None
) -> tuple[Dynamics, Callable[[float], None]]:
    """The stepper, and what gives its forces another softness; buttons are softer yet, because the shank of one that has just closed stands aslant, and would
    tear at the cloth below until it lies the other way up.

    dressing: while seams are sewn and folds pressed there are no bands, no pull of buttons, no weight and no friction, so that cloth slides to where seams
    close, and shear goes by chords: cloth that is bent as sharply as on its way there is beyond what arcs describe, and a fitted dress of GarmentCode did not
    close. path: of a body that moves.
    """
    touch = materials
    if dressing:
        touch = materials._replace(friction_body=0.0 * materials.friction_body, friction_cloth=0.0 * materials.friction_cloth)
    contact = Contact(cloth, touch, (job.mannequin.vertices, job.mannequin.faces), path=path)  # first: nothing needs as much memory while it is made
    weight = [] if dressing else [ForceGravity(cloth.masses)]
    pulls: list[Force] = []
    if job.pattern.bands and not dressing:
        pulls.append(ForceBand(band_segments(job.pattern, cloth)))
    buttons = [ForceButton(button_shanks(job.pattern, cloth, materials))] if job.pattern.buttons and not dressing else []
    forces = ForceAssembly([*internal_forces(cloth, materials, fold_angles=fold_angles, arcs=not dressing), *pulls, *buttons], cloth.particle_count, weight)

    def soften_all(softness: float) -> None:
        soften(forces.forces, cloth, materials, softness)
        for button in buttons:
            button.soften(softness**2)

    if dressing and job.mode == "drape":
        soften_all(SOFTNESS)
    return Dynamics(cloth, forces, strain_limit(cloth, materials), contact), soften_all
