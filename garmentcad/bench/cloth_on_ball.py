"""Workload W1, cloth on a ball: a square cloth falls on a ball and comes to rest. Small enough to state in a few numbers, and other programs can do it too.

World frame: metres, y up. The cloth has one panel and no seams; the fabric is an imagined one with linear laws.
"""

from __future__ import annotations

import numpy as np
import trimesh

from garmentcad.arrays import floats, frozen, indices
from garmentcad.fabric.missing import complete
from garmentcad.fabric.sheet import KesSheet, sheet_from
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.simulation.job import Job
from garmentcad.units import GF_CM2_CM_TO_N_M, GF_CM_DEG_TO_N_M_RAD, GF_CM_TO_N_M, M_TO_MM, MG_CM2_TO_KG_M2

NAME = "cloth-on-ball"
SIDE_M = 1.0
RADIUS_M = 0.25
CENTER_M = (0.0, 1.0, 0.0)
START_M = 0.005  # of the flat cloth above the top of the ball
AREAL_MASS_KG_M2 = 0.15
TENSION_N_M = 2000.0
SHEAR_N_M_RAD = 50.0
BENDING_N_M = 1e-5
GAP_M = 0.003  # of mid-surfaces, from cloth to cloth and from cloth to ball
# Half of a fabric's thickness is its gap to a body. The ball is drawn larger by the other half, so that the cloth rests where that of other programs does.
DRAWN_RADIUS_M = RADIUS_M + 0.5 * GAP_M
FRICTION = 0.3  # of the cloth on the ball; cloth on cloth follows by the rule of all fabrics

_FM_GF_CM = 500.0
# 20480 faces with edges of 9 mm: they lie at most 0.04 mm below the ball.
_SUBDIVISIONS = 5


def cloth_on_ball(grid_mm: float = 10.0, seed: int = 0) -> Job:
    """The job of W1, as `make_job` gives it for a garment that has files."""
    spec, body = square_spec(), ball()
    return Job(spec, draft(spec, body.measurements_mm), {spec.fabric: complete(linear_sheet())}, body, grid_mm, seed)


def square_spec(side_m: float = SIDE_M) -> GarmentSpec:
    """One square panel, grainline along its y, laid level above the ball with its right side up."""
    half = 0.5 * M_TO_MM * side_m
    height = M_TO_MM * (CENTER_M[1] + RADIUS_M + START_M)
    corners = {"a": [-half, -half], "b": [half, -half], "c": [half, half], "d": [-half, half]}
    edges = [{"name": start + end, "from": start, "to": end} for start, end in ("ab", "bc", "cd", "da")]
    placement = {"transform": {"translation": [M_TO_MM * CENTER_M[0], height, M_TO_MM * CENTER_M[2]], "rotation": [-90, 0, 0]}}
    panel = {"points": corners, "edges": edges, "placement": placement}
    return parse_spec({"schema": 1, "units": "mm", "name": NAME, "fabric": "linear", "mannequin": "ball", "panels": {"square": panel}})


def linear_sheet(gap_m: float = GAP_M) -> KesSheet:
    """The fabric in tester units. LT = 1 makes the tensile curve a line, EMT its slope; the bias bends like warp and weft, so that bending has no direction."""
    bending = BENDING_N_M / GF_CM2_CM_TO_N_M
    values = {
        "W": AREAL_MASS_KG_M2 / MG_CM2_TO_KG_M2,
        "T0": M_TO_MM * gap_m,
        "Fm": _FM_GF_CM,
        "LT": 1.0,
        "RT": 100.0,
        "EMT": 100.0 * _FM_GF_CM * GF_CM_TO_N_M / TENSION_N_M,
        "G": SHEAR_N_M_RAD / GF_CM_DEG_TO_N_M_RAD,
        "2HG": 0.0,
        "2HG5": 0.0,
        "B": {"warp": bending, "weft": bending, "bias": bending},
        "2HB": {"warp": 0.0, "weft": 0.0, "bias": 0.0},
        "MIU": FRICTION,
    }
    return sheet_from({"schema": 1, "name": "linear", "source": "workload W1, an imagined fabric", **values})


def ball() -> Mannequin:
    """The ball as a body: vertices at DRAWN_RADIUS_M from its centre; it has no girths, landmarks or limbs."""
    mesh = trimesh.creation.icosphere(subdivisions=_SUBDIVISIONS, radius=DRAWN_RADIUS_M)
    faces = frozen(indices(mesh.faces))
    return Mannequin("ball", frozen(floats(mesh.vertices + np.array(CENTER_M))), faces, {}, {}, {}, ("ball",), frozen(indices(np.zeros(len(faces)))))


def mean_height_mm(positions: np.ndarray) -> float:
    """Mean height of particles (P,3) m above the ball's centre."""
    return M_TO_MM * (float(positions[:, 1].mean()) - CENTER_M[1])
