"""Stretch and shear of the triangles between full cells and contour.

    u = sum_k warp_gradient[k] x[k],  w = sum_k weft_gradient[k] x[k]     (unit length at rest)
    patch p (the triangles t around a vertex):  e_p = sum_t(A_t (|u_t| - 1))/sum_t(A_t), alike in the weft,  A_p = sum_t(A_t)/3
    E = sum_p A_p (f_warp(e_p) + f_weft(e_p)) + sum_t A_t g(gamma_t)   [J]
      + STEADY sum_(warp, weft) sum_p k_p/2 (sum_t A_t e_t^2/3 - A_p e_p^2),   e_t = |u_t| - 1, |w_t| - 1

f and g are what the tensile and shear laws of the sheet store, each with its slider: two a patch, one a triangle. Averaging over patches keeps
constant-strain triangles from locking in shear. The exact gradient is the patch stress pulled back: a triangle carries the mean stress of its three patches.
Means do not see strains that change their sign from triangle to triangle; the last sum, never negative, and nothing where strain is even, does. k_p is
the initial slope of the curve.
Damping as in stretch.py and shear.py, on the rates of e_p, e_t and gamma_t.
Source: patch averaging after nodally averaged triangles (Bonet and Burton 1998), with a share of the triangles' own energy (Puso and Solberg 2006).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from garmentcad.arrays import entry, floats, indices, kernel, making_kernel, row_kernel, rows_by_key
from garmentcad.cloth.cloth import WARP, WEFT, BorderTriangles, Cloth
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_shear import stick_stiffness
from garmentcad.fabric.law_tension import WAY
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import CURVES, Gauge, OneLaw, between
from garmentcad.forces.rows import PART
from garmentcad.forces.shear import (
    SHORTEST,
    angle_and_lengths,
    chord_angle,
    chord_gradients,
    chord_products,
    largest_shear_stiffness,
    shear_curves,
    shear_energy_at,
)
from garmentcad.forces.stretch import COEFFICIENTS, tension_coefficients, tension_force
from garmentcad.forces.tension_curves import largest_tension_at, tension_curves, tension_energy_at

STEADY = 0.05  # share of the initial slope with which triangles keep to the mean of their patches, as Puso and Solberg have it for solids


class BorderParts(NamedTuple):
    """The triangles in parts of PART that lie together. A part is computed by itself: it holds its own triangles and then those that share a patch with them,
    whose strains are computed here too, and its own copies of the patches. L triangles, K patches over all parts."""

    first: np.ndarray  # (N+1,) int32 of the L triangles of each part
    first_patch: np.ndarray  # (N+1,) int32 of the K patches of each part
    corners: np.ndarray  # (3,L) int32
    gradients: np.ndarray  # (4,L) 1/m of corners 1 and 2, warp and then weft; corner 0 has minus their sum
    patch_of: np.ndarray  # (K,) int32 of the cloth's P patches
    owned: np.ndarray  # (K,) bool: no part before holds this patch
    patch_area: np.ndarray  # (K,) A_p, m2
    area: np.ndarray  # (T,) m2
    shear: np.ndarray  # (4,T) G_e, the stick spring's two, N/m per rad; d, rad
    patch: np.ndarray  # (3,T) int32 in the part
    entry_first: np.ndarray  # (K+1,) int32 of the entries of each patch
    entry_triangle: np.ndarray  # (E,) int32 in the part
    entry_weight: np.ndarray  # (E,) area over the patch's area
    tension: np.ndarray  # (8,K) coefficients of `tension_force`, warp and then weft


@row_kernel
def _load_edges(span, corners, positions, velocities, edges):  # type: ignore[no-untyped-def]
    """Edges from corner 0 to 1 and to 2, and their velocities, into edges (12+,L); span: first triangle, number."""
    first, count = span
    x, v = positions, velocities
    for i in range(count):
        a, b, c = corners[0, first + i], corners[1, first + i], corners[2, first + i]
        for axis in range(3):
            edges[axis, i], edges[3 + axis, i] = x[b, axis] - x[a, axis], x[c, axis] - x[a, axis]
            edges[6 + axis, i], edges[9 + axis, i] = v[b, axis] - v[a, axis], v[c, axis] - v[a, axis]


@row_kernel
def _strain_row(count, along_b, along_c, edges, directions, strains):  # type: ignore[no-untyped-def]
    """Warp or weft of a row of triangles: u/|u| into directions (3+,L), |u| - 1 and its rate into strains (2+,L)."""
    bx, by, bz, cx, cy, cz = edges[0], edges[1], edges[2], edges[3], edges[4], edges[5]
    bu, bv, bw, cu, cv, cw = edges[6], edges[7], edges[8], edges[9], edges[10], edges[11]
    ex, ey, ez, strain, rate = directions[0], directions[1], directions[2], strains[0], strains[1]
    for i in range(np.uint64(count)):
        g, h = along_b[i], along_c[i]
        x, y, z = g * bx[i] + h * cx[i], g * by[i] + h * cy[i], g * bz[i] + h * cz[i]
        length = math.sqrt(x * x + y * y + z * z)
        inverse = 1.0 / max(length, SHORTEST)
        x, y, z = x * inverse, y * inverse, z * inverse
        ex[i], ey[i], ez[i], strain[i] = x, y, z, length - 1.0
        rate[i] = x * (g * bu[i] + h * cu[i]) + y * (g * bv[i] + h * cv[i]) + z * (g * bw[i] + h * cw[i])


@kernel
def _mean_strains(span, parts, strains, means):  # type: ignore[no-untyped-def]
    """Area means over patches of strains (4,L) into means (4,K); span: first patch, number."""
    first, count = span
    for p in range(count):
        warp = warp_rate = weft = weft_rate = 0.0
        for j in range(parts.entry_first[first + p], parts.entry_first[first + p + 1]):
            t, weight = parts.entry_triangle[j], parts.entry_weight[j]
            warp += weight * strains[0, t]
            warp_rate += weight * strains[1, t]
            weft += weight * strains[2, t]
            weft_rate += weight * strains[3, t]
        means[0, p], means[1, p], means[2, p], means[3, p] = warp, warp_rate, weft, weft_rate


@kernel
def _load_sliders(span, patch_of, sliders, axis, held):  # type: ignore[no-untyped-def]
    first, count = span
    for p in range(count):
        held[p] = sliders[2 * patch_of[first + p] + axis]


@kernel
def _keep_sliders(span, parts, held, gone, axis, sliders):  # type: ignore[no-untyped-def]
    """Sliders of the patches that this part owns; returns the energy that they lost [J]. Parts that share a patch find the same for it."""
    first, count = span
    total = 0.0
    for p in range(count):
        if parts.owned[first + p]:
            sliders[2 * parts.patch_of[first + p] + axis] = held[p]
            total += parts.patch_area[first + p] * gone[p]
    return total


@row_kernel
def _stress_row(count, damping_time, curves, first, held, means, gone):  # type: ignore[no-untyped-def]
    """Tension [N/m] of patches, less what steadies their triangles, in place of their strains, and the slope of that in place of their rates, from strains and
    rates (2,K). Moves their sliders held (K,); energy lost per area into gone (K,)."""
    rate, amplitude, em, stick = curves[0, first:], curves[1, first:], curves[2, first:], curves[3, first:]
    strain, speed = means[0], means[1]
    for p in range(np.uint64(count)):
        mean, damped, slope = strain[p], damping_time * speed[p], STEADY * (rate[p] * amplitude[p])
        tension, held[p], gone[p] = tension_force(mean, damped, held[p], rate[p], amplitude[p], em[p], stick[p])
        strain[p], speed[p] = tension - slope * (mean + damped), slope


@kernel
def _mean_stresses(span, damping_time, patch, means, strains, stresses):  # type: ignore[no-untyped-def]
    """Warp and weft stress of triangles from their three patches and their own strains; span: first triangle, number."""
    first, count = span
    for i in range(count):
        p, q, r = patch[0, first + i], patch[1, first + i], patch[2, first + i]
        for axis in range(2):
            k = 2 * axis
            slope, own = means[k + 1, p] + means[k + 1, q] + means[k + 1, r], strains[k, i] + damping_time * strains[k + 1, i]
            stresses[axis, i] = (1.0 / 3.0) * (means[k, p] + means[k, q] + means[k, r] + slope * own)


@row_kernel
def _force_row(span, damping_time, parts, sliders, edges, directions, stresses):  # type: ignore[no-untyped-def]
    """Forces on corners 1 and 2 of triangles, in place of their edges, and the energy lost [J], in place of their warp stress; span: first of the L and of
    the T triangles, number. Moves the sliders (T,) of shear."""
    begin, first, count = span
    warp_b, warp_c, weft_b, weft_c = parts.gradients[0, begin:], parts.gradients[1, begin:], parts.gradients[2, begin:], parts.gradients[3, begin:]
    area, slider = parts.area[first:], sliders[first:]
    stiffness, low, rise, way = parts.shear[0, first:], parts.shear[1, first:], parts.shear[2, first:], parts.shear[3, first:]
    bx, by, bz, cx, cy, cz = edges[0], edges[1], edges[2], edges[3], edges[4], edges[5]
    bu, bv, bw, cu, cv, cw = edges[6], edges[7], edges[8], edges[9], edges[10], edges[11]
    dx, dy, dz, ex, ey, ez = directions[0], directions[1], directions[2], directions[3], directions[4], directions[5]
    warp, weft = stresses[0], stresses[1]
    for i in range(np.uint64(count)):
        g, h, k, m = warp_b[i], warp_c[i], weft_b[i], weft_c[i]
        ux, uy, uz = g * bx[i] + h * cx[i], g * by[i] + h * cy[i], g * bz[i] + h * cz[i]
        wx, wy, wz = k * bx[i] + m * cx[i], k * by[i] + m * cy[i], k * bz[i] + m * cz[i]
        uu, ww, dot = chord_products(ux, uy, uz, wx, wy, wz)
        gamma, inverse, share_u, share_w = chord_angle(uu, ww, dot)
        gux, guy, guz, gwx, gwy, gwz = chord_gradients(ux, uy, uz, wx, wy, wz, inverse, share_u, share_w)
        rate = gux * (g * bu[i] + h * cu[i]) + guy * (g * bv[i] + h * cv[i]) + guz * (g * bw[i] + h * cw[i])
        rate += gwx * (k * bu[i] + m * cu[i]) + gwy * (k * bv[i] + m * cv[i]) + gwz * (k * bw[i] + m * cw[i])
        after = dragged(slider[i], gamma, way[i])
        held = gamma - after
        shearing = -area[i] * (stiffness[i] * (gamma + damping_time * rate) + stick_stiffness(gamma, low[i], rise[i]) * held)
        gone = area[i] * stick_stiffness(gamma - 0.5 * held, low[i], rise[i]) * way[i] * abs(after - slider[i])
        slider[i] = after
        along_warp, along_weft = -area[i] * warp[i], -area[i] * weft[i]
        ux, uy, uz = along_warp * dx[i] + shearing * gux, along_warp * dy[i] + shearing * guy, along_warp * dz[i] + shearing * guz
        wx, wy, wz = along_weft * ex[i] + shearing * gwx, along_weft * ey[i] + shearing * gwy, along_weft * ez[i] + shearing * gwz
        bx[i], by[i], bz[i] = g * ux + k * wx, g * uy + k * wy, g * uz + k * wz
        cx[i], cy[i], cz[i] = h * ux + m * wx, h * uy + m * wy, h * uz + m * wz
        warp[i] = gone


@making_kernel
def border_part(part, parts, damping_time, sliders, positions, velocities, out):  # type: ignore[no-untyped-def]
    """sliders (T + 2 P,): of shear, then of warp and weft patch by patch. Returns the energy lost [J]."""
    begin, end = np.int64(parts.first[part]), np.int64(parts.first[part + 1])
    begin_patch, end_patch = np.int64(parts.first_patch[part]), np.int64(parts.first_patch[part + 1])
    first = part * PART
    own = min(len(parts.area) - first, PART)
    count, patches = end - begin, end_patch - begin_patch
    edges, directions, strains, means, stresses = np.empty((12, count)), np.empty((6, count)), np.empty((4, count)), np.empty((4, patches)), np.empty((2, own))
    held, total = np.empty((2, patches)), 0.0
    of_patches = sliders[len(parts.area) :]
    _load_edges((begin, count), parts.corners, positions, velocities, edges)
    for axis in range(2):
        _strain_row(
            count, parts.gradients[2 * axis, begin:], parts.gradients[2 * axis + 1, begin:], edges, directions[3 * axis :], strains[2 * axis :]
        )  # fmt: skip
    _mean_strains((begin_patch, patches), parts, strains, means)
    for axis in range(2):
        _load_sliders((begin_patch, patches), parts.patch_of, of_patches, axis, held[0])
        _stress_row(patches, damping_time, parts.tension[COEFFICIENTS * axis :], begin_patch, held[0], means[2 * axis :], held[1])
        total += _keep_sliders((begin_patch, patches), parts, held[0], held[1], axis, of_patches)
    _mean_stresses((first, own), damping_time, parts.patch, means, strains, stresses)
    _force_row((begin, first, own), damping_time, parts, sliders, edges, directions, stresses)
    for i in range(own):
        k = 3 * (first + i)
        for axis in range(3):
            b, c = edges[axis, i], edges[3 + axis, i]
            out[k, axis], out[k + 1, axis], out[k + 2, axis] = -(b + c), b, c
        total += stresses[0, i]
    return total


@entry
@kernel
def write_border(parts, damping_time, sliders, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of triangle i into out[3 i] to out[3 i + 2]. Returns the energy lost [J]."""
    lost = 0.0
    for part in range(len(parts.first) - 1):
        lost += border_part(part, parts, damping_time, sliders, positions, velocities, out)
    return lost


class ForceBorder(OneLaw):
    """Stretch and shear of the border triangles of `cloth`. damping_time: tau [s]."""

    name = "border"

    def __init__(self, cloth: Cloth, materials: MaterialTable, damping_time: float = 0.0) -> None:
        self._border = border = _in_order(cloth.border)
        self._alone = np.bincount(cloth.vertex_particle, minlength=cloth.particle_count) == 1
        sizes = np.diff(border.patch_start)
        self._of_entry = np.repeat(np.arange(len(sizes)), sizes)
        self._patch_area = np.bincount(self._of_entry, weights=border.area[border.patch_triangle], minlength=len(sizes))
        self._patch_curve = indices(2 * border.patch_material[:, None] + np.array([WARP, WEFT]))
        self._parts = _parts(border, self._patch_area)
        self.set_plane(materials)
        self.way = np.concatenate([self._shear.way, WAY * self._curves.em[self._patch_curve].ravel()])
        self.damping_time = damping_time
        self.corners = indices(border.corners).ravel()

    def set_plane(self, materials: MaterialTable) -> None:
        """From now on tension and shear are those of other materials; what strains mean, and where friction gives way, must be the same."""
        self._shear, self._curves = shear_curves(materials, self._border.material), tension_curves(materials)
        tension = np.concatenate([tension_coefficients(self._curves, self._patch_curve[:, axis]) for axis in (WARP, WEFT)])
        self._parts = self._parts._replace(shear=np.stack(self._shear), tension=floats(tension[:, self._parts.patch_of]))

    @property
    def arguments(self) -> tuple[Any, ...]:
        """What `write_border` takes before sliders, positions, velocities and out."""
        return self._parts, self.damping_time

    def slack(self) -> np.ndarray:
        sliders = np.zeros(len(self.way))
        count = len(self._border.area)
        sliders[count:] = -self.way[count:]
        return sliders

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_border(*self.arguments, self.slack() if sliders is None else sliders, positions, velocities, out)

    def _vectors(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        corners = positions[self._border.corners]
        return np.einsum("tk,tkc->tc", self._border.warp_gradient, corners), np.einsum("tk,tkc->tc", self._border.weft_gradient, corners)

    def _patch_mean(self, values: np.ndarray) -> np.ndarray:
        """Area mean (K,) over each patch of one value per triangle (T,)."""
        entries = (self._border.area * values)[self._border.patch_triangle]
        return np.bincount(self._of_entry, weights=entries, minlength=len(self._patch_area)) / self._patch_area

    def _strains(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """gamma (T,), warp and weft strain (T,2) of the triangles, and e (P,2) of the patches."""
        warp, weft = self._vectors(positions)
        gamma, _, _ = angle_and_lengths(warp, weft)
        own = np.column_stack([np.linalg.norm(vector, axis=1) - 1.0 for vector in (warp, weft)])
        return gamma, own, np.column_stack([self._patch_mean(own[:, axis]) for axis in (WARP, WEFT)])

    def _steadying(self, axis: int) -> np.ndarray:
        """STEADY k (P,) [N/m] of the patches."""
        return STEADY * np.asarray(self._curves.slope[self._patch_curve[:, axis]])

    def strain(self, positions: np.ndarray) -> np.ndarray:
        """Of every slider (T + 2 P,)."""
        gamma, _, patches = self._strains(positions)
        return np.concatenate([gamma, patches.ravel()])

    def gauge(self, positions: np.ndarray) -> Gauge:
        border, tension = self._border, [CURVES.index("warp tension"), CURVES.index("weft tension")]
        curve = np.concatenate([np.full(len(border.area), CURVES.index("shear")), np.tile(tension, len(self._patch_area))])
        # a corner that belongs to one panel, where there is one
        inner = border.corners[np.arange(len(border.area)), np.argmax(self._alone[border.corners], axis=1)]
        of_patch = inner[border.patch_triangle[border.patch_start[:-1]]] if len(border.area) else inner
        middle = np.zeros(len(self._patch_area), dtype=np.int32)
        middle[border.patch] = border.corners
        places = np.concatenate([between(border.corners), between(np.repeat(middle, 2)[:, None])])
        return Gauge(self.strain(positions), self.way, curve, np.concatenate([inner, np.repeat(of_patch, 2)]), places)

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        gamma, own, patches = self._strains(positions)
        held = self.slack() if sliders is None else sliders
        of_patches = held[len(gamma) :].reshape(-1, 2)
        total = float(np.sum(shear_energy_at(self._shear, gamma, held[: len(gamma)]) * self._border.area))
        for axis in (WARP, WEFT):
            energy = tension_energy_at(self._curves, self._patch_curve[:, axis], patches[:, axis], of_patches[:, axis])
            uneven = self._patch_mean(own[:, axis] ** 2) - patches[:, axis] ** 2
            total += float(np.sum((energy + 0.5 * self._steadying(axis) * uneven) * self._patch_area)) / 3.0
        return total

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        warp, weft = self._vectors(positions)
        gamma, warp_length, weft_length = angle_and_lengths(warp, weft)
        self._write_bound((warp, weft), (warp_length, weft_length), largest_shear_stiffness(self._shear, gamma), out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """Row sums without friction, at rest, wherever the panels lie."""
        count = len(self._border.area)
        vectors = np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1))
        self._write_bound(vectors, (np.ones(count), np.ones(count)), self._shear.stiffness, out)

    def _write_bound(self, vectors: tuple[np.ndarray, np.ndarray], lengths: tuple[np.ndarray, np.ndarray], shear: np.ndarray, out: np.ndarray) -> None:
        # tension: |de_p/dx| by the triangle inequality along the fibre, and T/|u| across it, which only tension stiffens
        border = self._border
        gradients = border.warp_gradient, border.weft_gradient
        # |dgamma/dx|^2 of a corner, from its parts along warp and weft, which enclose the trellis angle
        along, across = (parts / length[:, None] for parts, length in zip(gradients, lengths))
        lean = np.sum(vectors[0] * vectors[1], axis=1) / (lengths[0] * lengths[1])
        gradient = np.sqrt(np.maximum(along**2 + across**2 - 2.0 * lean[:, None] * along * across, 0.0))
        bound = (shear * border.area)[:, None] * gradient * gradient.sum(axis=1, keepdims=True)
        for axis, vector, length, parts in zip((WARP, WEFT), vectors, lengths, gradients):
            reach = np.abs(parts).sum(axis=1)
            own = np.linalg.norm(vector, axis=1) - 1.0
            mean = self._patch_mean(own)
            force, tangent = largest_tension_at(self._curves, self._patch_curve[:, axis], mean)
            slope = self._steadying(axis)
            steady = slope[border.patch].mean(axis=1)
            # what steadies adds no more than the triangle's own energy alone would
            along = (tangent * self._patch_mean(reach))[border.patch].mean(axis=1) + steady * reach
            pull = (np.maximum(force, 0.0) - slope * mean)[border.patch].mean(axis=1) + steady * own
            across = np.maximum(pull, 0.0) * reach / length
            bound += (border.area * (along + across))[:, None] * np.abs(parts)
        out[:] = bound.ravel()


def _in_order(border: BorderTriangles) -> BorderTriangles:
    """The same triangles, those that share patches near to each other."""
    count = len(border.area)
    entries = np.ones(3 * count), (np.repeat(np.arange(count), 3), border.patch.ravel())
    of_patch = csr_array(entries, shape=(count, len(border.patch_material)))
    neighbours = (of_patch @ of_patch.T).tocsr()
    first = np.unique(connected_components(neighbours, directed=False)[1], return_index=True)[1]
    order = np.concatenate([np.empty(0, np.int64), *(breadth_first_order(neighbours, at, directed=False, return_predecessors=False) for at in first)])
    patch = border.patch[order]
    starts, rows = rows_by_key(patch.ravel(), len(border.patch_material))
    fields = {name: getattr(border, name)[order] for name in ("corners", "area", "warp_gradient", "weft_gradient", "material")}
    return border._replace(patch=patch, patch_start=starts, patch_triangle=indices(rows // 3), **fields)


def _parts(border: BorderTriangles, patch_area: np.ndarray) -> BorderParts:
    """Without the curves."""
    triangles, patches, own_patches, entry_counts, entries, weights = [], [], [], [], [], []
    none = np.empty(0, dtype=np.int64)
    for first in range(0, len(border.area), PART):
        own = np.arange(first, min(first + PART, len(border.area)))
        mine, local = np.unique(border.patch[own], return_inverse=True)
        own_patches.append(local.reshape(-1, 3))
        rows = [border.patch_triangle[border.patch_start[p] : border.patch_start[p + 1]] for p in mine]
        held = np.concatenate(rows)
        together = np.concatenate([own, np.setdiff1d(held, own)])
        place = np.argsort(together, kind="stable")
        triangles.append(together)
        patches.append(mine)
        entry_counts += [len(row) for row in rows]
        entries.append(place[np.searchsorted(together[place], held)])
        weights.append(border.area[held] / np.repeat(patch_area[mine], [len(row) for row in rows]))
    every, every_patch = np.concatenate([none, *triangles]), np.concatenate([none, *patches])
    owned = np.zeros(len(every_patch), dtype=bool)
    owned[np.unique(every_patch, return_index=True)[1]] = True
    gradients = [border.warp_gradient[every, 1], border.warp_gradient[every, 2], border.weft_gradient[every, 1], border.weft_gradient[every, 2]]
    return BorderParts(
        indices(np.cumsum([0, *(len(part) for part in triangles)])),
        indices(np.cumsum([0, *(len(part) for part in patches)])),
        indices(border.corners[every].T),
        floats(np.stack(gradients)),
        indices(every_patch),
        owned,
        floats(patch_area[every_patch] / 3.0),
        np.array(border.area),
        np.empty((4, 0)),
        indices(np.concatenate([np.empty((0, 3), dtype=np.int64), *own_patches]).T),
        indices(np.cumsum([0, *entry_counts])),
        indices(np.concatenate([none, *entries])),
        floats(np.concatenate([none, *weights])),
        np.empty((2 * COEFFICIENTS, 0)),
    )
