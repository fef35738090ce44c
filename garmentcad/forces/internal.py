"""The internal forces of a cloth, with internal damping set by rule."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import indices, inlined, long_kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable, softened
from garmentcad.forces import bend as bend_lines
from garmentcad.forces.band import ForceBand, no_bands, write_bands
from garmentcad.forces.bend import bend_part
from garmentcad.forces.border import ForceBorder, border_part
from garmentcad.forces.button import ForceButton, no_shanks, write_shanks
from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.hinge import ForceHinge, hinge_part
from garmentcad.forces.lattice import ForceLattice, contour_lines, lattice_block
from garmentcad.forces.rows import PART
from garmentcad.forces.span import ForceSpan, span_part
from garmentcad.forces.time_step import DAMPING_RATIO, internal_damping_time

LAWS = ("lattice", "border", "bend", "span", "hinge")
HARDWARE = (ForceBand.name, ForceButton.name)
# The parts of all forces are dealt out in so many bins, whatever the number of threads: in halves of about the same work, these in halves again, because
# threads take bins that follow each other.
BINS = 8
# Work of an element, us: of lattice blocks a slot, of the others one of the 128 elements of a part (measured, one thread).
_WORK = (0.02, 0.022, 0.01, 0.014, 0.014)


@inlined
def _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Returns the energy lost [J]."""
    if kind == 0:
        return lattice_block(part, blocks, (coefficients, held[0]), setting, positions, velocities, rooms, out[first[0] : first[1]])
    if kind == 1:
        return border_part(part, border, setting[1], held[1], positions, velocities, out[first[1] : first[2]])
    if kind == 2:
        return bend_part(part, bend, held[2], positions, out[first[2] : first[3]])
    if kind == 4:
        return hinge_part(part, hinge, held[3], positions, out[first[4] : first[5]])
    span_part(part, span, positions, out[first[3] : first[4]])
    return 0.0


@long_kernel
def _one_bin(number, deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out, lost):  # type: ignore[no-untyped-def]
    for k in range(deal.start[number], deal.start[number + 1]):
        kind, part = np.int64(deal.kind[k]), np.int64(deal.part[k])
        lost[number] += _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out)


@parallel_kernel
def _write_all(deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, s0, s1, s2, s3, positions, velocities, out, lost):  # type: ignore[no-untyped-def]
    for number in prange(BINS):
        held = s0, s1, s2, s3  # of lattice, border, bend, hinge
        _one_bin(np.int64(number), deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out, lost)


@inlined
def write_internal(laws, positions, velocities, corner_forces):  # type: ignore[no-untyped-def]
    """All corner forces, in one parallel region. laws: see `law_arguments`."""
    deal, first, lattice, border, bend, span, hinge, (a, b, c, d), lost, bands, shanks = laws
    blocks, coefficients, setting, rooms = lattice
    _write_all(
        deal, first, blocks, coefficients, setting, rooms, border[0], bend[0], span[0], hinge[0], a, b, c, d, positions, velocities, corner_forces, lost,
    )  # fmt: skip
    write_bands(bands, positions, corner_forces[first[5] :])
    write_shanks(shanks, positions, velocities, corner_forces[first[6] :])


class Deal(NamedTuple):
    """Parts of all forces in bins of about the same work: bin b holds kind and part (K,) from start[b] to start[b+1]."""

    start: np.ndarray
    kind: np.ndarray
    part: np.ndarray


def law_arguments(forces: tuple[Any, ...], sliders: dict[str, np.ndarray], lost: np.ndarray) -> tuple[Any, ...]:
    """Arguments of `write_internal` for the forces of `internal_forces`, which a `ForceBand` and a `ForceButton` may follow: the deal, where the corners of
    each begin, what each compiled law needs, the sliders by name of force, which are moved, and lost (BINS,), to which the energy that they lose [J] is added,
    the bands and the shanks of buttons."""
    if tuple(force.name for force in forces) not in [(*LAWS, *more) for more in ((), HARDWARE[:1], HARDWARE[1:], HARDWARE)]:
        raise ValueError(f"forces {[force.name for force in forces]}; the stepper knows {list(LAWS)}, in this order, and {list(HARDWARE)} after them")
    lattice, border, bend, span, hinge = forces[: len(LAWS)]
    more = {force.name: force for force in forces[len(LAWS) :]}
    bands = more[ForceBand.name].segments if ForceBand.name in more else no_bands()
    shanks = more[ForceButton.name].shanks if ForceButton.name in more else no_shanks()
    corners = (1, 3, bend_lines.CORNERS, 4, 4)
    sizes = [lattice.arguments[0].size]
    for force, per_element in zip((border, bend, span, hinge), corners[1:]):
        count = len(force.corners) // per_element
        sizes.append(np.minimum(PART, count - PART * np.arange(-(-count // PART))))
    kind, part = np.repeat(np.arange(len(LAWS)), [len(size) for size in sizes]), np.concatenate([np.arange(len(size)) for size in sizes])
    work = np.concatenate([cost * size for cost, size in zip(_WORK, sizes)])
    bins = dealt(work)
    order = np.array([k for one in bins for k in one], dtype=np.int64)
    start = np.cumsum([0, *(len(one) for one in bins)])
    first = np.cumsum([0, *(len(force.corners) for force in forces[: len(LAWS)]), bands.particles.size])
    deal = Deal(indices(start), indices(kind[order]), indices(part[order]))
    held = tuple(sliders[force.name] for force in (lattice, border, bend, hinge))
    return deal, first, *(force.arguments for force in forces[: len(LAWS)]), held, lost, bands, shanks


def dealt(work: np.ndarray) -> list[list[int]]:
    """Parts in BINS bins by their work (K,): as near to each other as may be are the halves of the bins, then their quarters, then the bins."""
    bins = [np.argsort(-work, kind="stable").tolist()]
    while len(bins) < BINS:
        bins = [half for one in bins for half in _halves(one, work)]
    return bins


def _halves(parts: list[int], work: np.ndarray) -> tuple[list[int], list[int]]:
    """Two halves of about the same work, of parts by falling work."""
    halves: tuple[list[int], list[int]] = ([], [])
    load = [0.0, 0.0]
    for part in parts:
        lighter = int(load[1] < load[0])
        halves[lighter].append(part)
        load[lighter] += work[part]
    return halves


def internal_forces(
    cloth: Cloth, materials: MaterialTable, damping_ratio: float = DAMPING_RATIO, fold_angles: np.ndarray | None = None, arcs: bool = True
) -> list[Force]:
    """Lattice (stretch, shear, twist, bend), border, bend lines that end on the contour, contour spans, and hinges over seams and folds of `cloth`.

    fold_angles (F,): rest angles of the folds, rad; None for flat ones. arcs: whether shear is measured with arcs (arcs.py) or with chords alone.

    Damping acts along the strain rates of stretch, shear and border with one time tau, so that the highest in-plane mode at rest, the stiffest of the cloth,
    has about `damping_ratio` (0 for none); lower modes have less in proportion to their frequency. Rigid motion is not damped.
    """
    damped = ForceLattice(cloth, materials, arcs=arcs), ForceBorder(cloth, materials)
    _damp(*damped, cloth.masses, damping_ratio)
    return [*damped, contour_lines(cloth, materials), ForceSpan(cloth, materials), ForceHinge(cloth, materials, fold_angles)]


def soften(forces: Sequence[Force], cloth: Cloth, materials: MaterialTable, softness: float, damping_ratio: float = DAMPING_RATIO) -> None:
    """From now on `forces`, those that `internal_forces` made of `materials` with this damping ratio, are those of materials that are `softened`: in place,
    and always from `materials`, whatever the softness before. softness: factor by which tension is divided, 1 for the fabric's own."""
    lattice, border = forces[:2]
    assert isinstance(lattice, ForceLattice)
    assert isinstance(border, ForceBorder)
    soft = softened(materials, softness)
    lattice.set_plane(soft)
    border.set_plane(soft)
    _damp(lattice, border, cloth.masses, damping_ratio)


def _damp(lattice: ForceLattice, border: ForceBorder, masses: np.ndarray, ratio: float) -> None:
    stiffness = np.zeros(len(masses))
    for force in (lattice, border):
        corner_stiffness = np.empty(len(force.corners))
        force.write_rest_stiffness(corner_stiffness)
        used = force.corners != NO_PARTICLE
        stiffness += np.bincount(force.corners[used], weights=corner_stiffness[used], minlength=len(stiffness))
    lattice.damping_time = border.damping_time = internal_damping_time(stiffness, masses, ratio)
