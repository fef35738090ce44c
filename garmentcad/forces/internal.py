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
# threads take bins that follow each other. A half is what lies side by side, as far as that goes, so that a thread finds in its own cache what it wrote in the
# last loop (adding up the forces on 10,000 particles took two threads 65 to 95 us instead of 150 where their cores are far apart).
BINS = 8
# Work of an element, us: of lattice blocks a slot, of the others one of the 128 elements of a part (measured, one thread).
_WORK = (0.02, 0.022, 0.01, 0.014, 0.014)
_PER_ELEMENT = (1, 3, bend_lines.CORNERS, 4, 4)  # corners


@inlined
def _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Returns the energy lost [J]. The lattice stands last, because it is compiled in this order and another process compiles the lattice meanwhile."""
    if kind == 1:
        return border_part(part, border, setting[1], held[1], positions, velocities, out[first[1] : first[2]])
    if kind == 2:
        return bend_part(part, bend, held[2], positions, out[first[2] : first[3]])
    if kind == 3:
        span_part(part, span, positions, out[first[3] : first[4]])
        return 0.0
    if kind == 4:
        return hinge_part(part, hinge, held[3], positions, out[first[4] : first[5]])
    return lattice_block(part, blocks, (coefficients, held[0]), setting, positions, velocities, rooms, out[first[0] : first[1]])


@long_kernel
def _one_bin(number, deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out, lost):  # type: ignore[no-untyped-def]
    for k in range(deal.start[number], deal.start[number + 1]):
        kind, part = deal.kind[k], deal.part[k]
        lost[number] += _one_part(kind, part, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out)


@parallel_kernel
def _write_all(deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, s0, s1, s2, s3, positions, velocities, out, lost):  # type: ignore[no-untyped-def]
    for number in prange(BINS):
        held = s0, s1, s2, s3  # of lattice, border, bend, hinge
        _one_bin(np.int64(number), deal, first, blocks, coefficients, setting, rooms, border, bend, span, hinge, held, positions, velocities, out, lost)


@inlined
def write_internal(laws, acting, positions, velocities, corner_forces):  # type: ignore[no-untyped-def]
    """Corner forces of the parts that act, of an `Acting`, in one parallel region. laws: see `law_arguments`."""
    first, lattice, border, bend, span, hinge, bands, shanks = laws
    blocks, coefficients, setting, rooms = lattice
    deal, (a, b, c, d), lost = acting
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


class Parts(NamedTuple):
    """Parts of the forces of a cloth, and what is the same in every step."""

    kind: np.ndarray  # (K,) number of the force in LAWS
    part: np.ndarray  # (K,) of that force
    work: np.ndarray  # (K,) us
    place: np.ndarray  # (K,) mean number of its particles
    owner: np.ndarray  # (C,) of each corner, all forces one after the other, bands and shanks left out
    corners: np.ndarray  # (C,) particle, or NO_PARTICLE
    first: np.ndarray  # (L+1,) where the corners of each force begin among all, bands as one of them

    def deal(self, chosen: np.ndarray) -> Deal:
        """Of the parts `chosen` (K,) bool."""
        numbers = np.flatnonzero(chosen)
        bins = dealt(self.work[numbers], self.place[numbers])
        order = numbers[[k for one in bins for k in one]]
        return Deal(indices(np.cumsum([0, *(len(one) for one in bins)])), indices(self.kind[order]), indices(self.part[order]))

    def around(self, particles: np.ndarray) -> np.ndarray:
        """(K,) bool: parts that act on some of the particles (P,) bool."""
        touched = np.zeros(len(self.kind), dtype=bool)
        used = self.corners != NO_PARTICLE
        touched[self.owner[used][particles[self.corners[used]]]] = True
        return touched


def lay_out_parts(forces: tuple[Any, ...]) -> Parts:
    """Of the forces of `internal_forces`, which a `ForceBand` and a `ForceButton` may follow; ValueError for others. A part lies where its mean particle is."""
    if tuple(force.name for force in forces) not in [(*LAWS, *more) for more in ((), HARDWARE[:1], HARDWARE[1:], HARDWARE)]:
        raise ValueError(f"forces {[force.name for force in forces]}; the stepper knows {list(LAWS)}, in this order, and {list(HARDWARE)} after them")
    blocks = forces[0].arguments[0]
    slots = [blocks.particle[first : first + size] for first, size in zip(blocks.first, blocks.size)]
    pieces = [[particles[particles != NO_PARTICLE] for particles in slots]]
    for force, per_element in zip(forces[1 : len(LAWS)], _PER_ELEMENT[1:]):
        step, end = PART * per_element, len(force.corners)
        pieces.append([np.arange(start, min(start + step, end)) for start in range(0, end, step)])
    sizes, corners = [len(of_law) for of_law in pieces], [force.corners for force in forces[: len(LAWS)]]
    first = np.cumsum([0, *(len(of_force) for of_force in corners)])
    owner = np.zeros(first[-1], dtype=np.int32)
    work: list[float] = []
    place: list[float] = []
    for kind, of_law in enumerate(pieces):
        for number, piece in enumerate(of_law):
            owner[first[kind] + piece] = len(work)
            # empty slots count as well, though loops leave most of them out: how many stages stiff parts are given hangs on this, and the bits of a drape
            elements = int(blocks.size[number]) if kind == 0 else len(piece) / _PER_ELEMENT[kind]
            work.append(_WORK[kind] * elements)
            place.append(_mean_particle(corners[kind][piece]))
    more = {force.name: force for force in forces[len(LAWS) :]}
    bands = more[ForceBand.name].segments.particles.size if ForceBand.name in more else 0
    return Parts(
        np.repeat(np.arange(len(LAWS)), sizes),
        np.concatenate([np.arange(size) for size in sizes]),
        np.array(work),
        np.array(place),
        owner,
        np.concatenate(corners),
        np.concatenate([first, first[-1:] + bands]),
    )


def _mean_particle(corners: np.ndarray) -> float:
    used = corners[corners != NO_PARTICLE]
    return float(used.mean()) if len(used) else 0.0


class Acting(NamedTuple):
    """What an evaluation of the forces takes, and what it changes."""

    deal: Deal
    sliders: tuple[np.ndarray, ...]  # of lattice, border, bend and hinge, which are moved
    lost: np.ndarray  # (BINS,), to which the energy that they lose [J] is added


def acting(deal: Deal, sliders: dict[str, np.ndarray], lost: np.ndarray) -> Acting:
    """Of sliders by name of force."""
    return Acting(deal, tuple(sliders[name] for name in ("lattice", "border", "bend", "hinge")), lost)


def law_arguments(first: np.ndarray, forces: tuple[Any, ...]) -> tuple[Any, ...]:
    """Arguments of `write_internal` that all evaluations share: where the corners of each force begin, what each compiled law needs, the bands and the shanks
    of buttons."""
    more = {force.name: force for force in forces[len(LAWS) :]}
    bands = more[ForceBand.name].segments if ForceBand.name in more else no_bands()
    shanks = more[ForceButton.name].shanks if ForceButton.name in more else no_shanks()
    return first, *(force.arguments for force in forces[: len(LAWS)]), bands, shanks


def dealt(work: np.ndarray, place: np.ndarray) -> list[list[int]]:
    """Parts in BINS bins by their work (K,) and place (K,): halves of all that lie side by side, then their quarters, then the bins. A half is cut where that
    shares the work best, and the heavier one gives the other what it has too much, first what lies near the cut."""
    bins = [np.arange(len(work))]
    while len(bins) < BINS:
        bins = [half for one in bins for half in _halves(one, work, place)]
    return [one.tolist() for one in bins]


def _halves(parts: np.ndarray, work: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the parts in each half, by their place."""
    parts = parts[np.argsort(place[parts], kind="stable")]
    excess = 2.0 * np.cumsum([0.0, *work[parts]]) - work[parts].sum()
    cut = int(np.argmin(np.abs(excess)))
    first, left = np.arange(len(parts)) < cut, abs(float(excess[cut]))
    heavy = np.arange(cut)[::-1] if excess[cut] > 0.0 else np.arange(cut, len(parts))
    given = []
    for k in heavy:
        if 2.0 * work[parts[k]] <= left:
            given.append(k)
            left -= 2.0 * work[parts[k]]
    rest = np.setdiff1d(heavy, given)
    after = np.abs(left - 2.0 * work[parts[rest]])
    if len(rest) and after.min() < left:
        given.append(rest[np.argmin(after)])
    first[given] = ~first[given]
    return parts[first], parts[~first]


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
