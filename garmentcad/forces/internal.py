"""The internal forces of a cloth, with internal damping set by rule."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import bend_part
from garmentcad.forces.border import ForceBorder, border_part
from garmentcad.forces.fold import CORNERS, ForceFold, fold_part
from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.hinge import ForceHinge, hinge_part
from garmentcad.forces.lattice import ForceLattice, contour_lines, lattice_block
from garmentcad.forces.rows import PART
from garmentcad.forces.span import ForceSpan, span_part
from garmentcad.forces.time_step import DAMPING_RATIO, internal_damping_time

LAWS = ("lattice", "border", "bend", "span", "hinge", "fold")
_BINS = 8  # the parts of all forces are dealt out in so many bins of about the same work, whatever the number of threads
# Work of an element, us: of lattice blocks a slot, of the others one of the 128 elements of a part (measured, one thread).
_WORK = (0.02, 0.022, 0.01, 0.014, 0.014, 0.03)


@kernel
def _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, fold, positions, velocities, out):  # type: ignore[no-untyped-def]
    if kind == 0:
        lattice_block(part, blocks, coefficients, setting, positions, velocities, rooms, out[first[0] : first[1]])
    elif kind == 1:
        border_part(part, border, setting[1], positions, velocities, out[first[1] : first[2]])
    elif kind == 2:
        bend_part(part, bend, positions, out[first[2] : first[3]])
    elif kind == 3:
        span_part(part, span, positions, out[first[3] : first[4]])
    elif kind == 4:
        hinge_part(part, hinge, positions, out[first[4] : first[5]])
    else:
        fold_part(part, fold, positions, out[first[5] : first[6]])


@kernel
def _one_bin(number, deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, fold, positions, velocities, out):  # type: ignore[no-untyped-def]
    for k in range(deal.start[number], deal.start[number + 1]):
        kind, part = np.int64(deal.kind[k]), np.int64(deal.part[k])
        _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, fold, positions, velocities, out)


@parallel_kernel
def _write_all(deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, fold, positions, velocities, out):  # type: ignore[no-untyped-def]
    for number in prange(_BINS):
        _one_bin(np.int64(number), deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, fold, positions, velocities, out)


@kernel
def write_internal(laws, positions, velocities, corner_forces):  # type: ignore[no-untyped-def]
    """All corner forces, in one parallel region. laws: see `law_arguments`."""
    deal, first, lattice, border, bend, span, hinge, fold = laws
    blocks, coefficients, setting, rooms = lattice
    _write_all(deal, first, blocks, coefficients, setting, rooms, border[0], bend[0], span[0], hinge[0], fold[0], positions, velocities, corner_forces)


class Deal(NamedTuple):
    """Parts of all forces in bins of about the same work: bin b holds kind and part (K,) from start[b] to start[b+1]."""

    start: np.ndarray
    kind: np.ndarray
    part: np.ndarray


def law_arguments(forces: tuple[Any, ...]) -> tuple[Any, ...]:
    """Arguments of `write_internal` for the forces of `internal_forces`: the deal, where the corners of each begin, and what each compiled law needs."""
    if tuple(force.name for force in forces) != LAWS:
        raise ValueError(f"forces {[force.name for force in forces]}; the stepper knows {list(LAWS)}, in this order")
    lattice, border, bend, span, hinge, fold = forces
    corners = (1, 3, 5, 4, 4, CORNERS)
    sizes = [lattice.arguments[0].size]
    for force, per_element in zip((border, bend, span, hinge, fold), corners[1:]):
        count = len(force.corners) // per_element
        sizes.append(np.minimum(PART, count - PART * np.arange(-(-count // PART))))
    kind, part = np.repeat(np.arange(len(LAWS)), [len(size) for size in sizes]), np.concatenate([np.arange(len(size)) for size in sizes])
    work = np.concatenate([cost * size for cost, size in zip(_WORK, sizes)])
    bins: list[list[int]] = [[] for _ in range(_BINS)]
    load = np.zeros(_BINS)
    for k in np.argsort(-work, kind="stable"):
        lightest = int(np.argmin(load))
        bins[lightest].append(int(k))
        load[lightest] += work[k]
    order = np.array([k for one in bins for k in one], dtype=np.int64)
    start = np.cumsum([0, *(len(one) for one in bins)])
    first = np.cumsum([0, *(len(force.corners) for force in forces)])
    return Deal(indices(start), indices(kind[order]), indices(part[order])), first, *(force.arguments for force in forces)


def internal_forces(cloth: Cloth, materials: MaterialTable, damping_ratio: float = DAMPING_RATIO, fold_angles: np.ndarray | None = None) -> list[Force]:
    """Lattice (stretch, shear, twist, bend), border, bend lines that end on the contour, contour spans, seam hinges and folds of `cloth`.

    fold_angles (F,): rest angles of the folds, rad; None for flat ones.

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
    return [*damped, contour_lines(cloth, materials), ForceSpan(cloth, materials), ForceHinge(cloth, materials), ForceFold(cloth, materials, fold_angles)]
