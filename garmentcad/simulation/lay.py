"""Lays: the same garment laid on a little differently, to see what a drape owes to its start.

Folds are bifurcations and friction holds a continuum of rests: what one drape says scatters with its lay, and a tolerance that does not know that is a guess.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from garmentcad.geometry.portable import norm
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Transform, Wrap
from garmentcad.simulation.job import Job
from garmentcad.units import M_TO_MM

DISPLACED_MM, TURNED_DEG = 5.0, 2.0


def displaced(job: Job, seed: int) -> Job:
    """The job with every panel moved rigidly on its way of laying: on its cylinder along, around and off it by a vector of at most DISPLACED_MM, and turned
    by at most TURNED_DEG about its anchor; a flat panel alike in space."""
    rng = np.random.default_rng(seed)
    panels = {name: replace(panel, placement=_moved(panel.placement, job.mannequin, rng)) for name, panel in job.pattern.panels.items()}
    return replace(job, pattern=replace(job.pattern, panels=panels))


def _moved(rule: Wrap | Transform, body: Mannequin, rng: np.random.Generator) -> Wrap | Transform:
    direction = rng.standard_normal(3)
    way = DISPLACED_MM * rng.uniform() ** (1 / 3) * direction / norm(direction)
    turn = rng.uniform(-TURNED_DEG, TURNED_DEG)
    if isinstance(rule, Transform):
        x, y, z = np.asarray(rule.translation_mm) + way
        about_x, about_y, about_z = rule.rotation_deg
        return replace(rule, translation_mm=(float(x), float(y), float(z)), rotation_deg=(about_x, about_y, about_z + turn))
    cylinder = body.cylinders[rule.part]
    radius = (0.5 * M_TO_MM * (cylinder.radius_ref + cylinder.radius_side) + rule.offset_mm) * rule.scale
    return replace(
        rule, angle_deg=rule.angle_deg + float(np.degrees(way[0] / radius)), height_mm=rule.height_mm + way[1], offset_mm=rule.offset_mm + way[2],
        turn_deg=rule.turn_deg + turn,
    )  # fmt: skip
