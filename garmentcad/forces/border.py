"""Stretch and shear of the triangles between full cells and contour.

    u = sum_k warp_gradient[k] x[k],  w = sum_k weft_gradient[k] x[k]     (unit length at rest)
    patch p (the triangles t around a vertex):  e_p = sum_t(A_t (|u_t| - 1))/sum_t(A_t), alike in the weft,  A_p = sum_t(A_t)/3
    E = sum_p A_p (f_warp(e_p) + f_weft(e_p)) + sum_t A_t g(gamma_t)   [J]

f and g are the tensile and shear laws of the sheet. Averaging over patches keeps constant-strain triangles from locking in shear. The exact gradient is the
patch stress pulled back: a triangle carries the mean stress of its three patches. Damping as in stretch.py and shear.py, on the rates of e_p and gamma_t.
Source: patch averaging after nodally averaged triangles (Bonet and Burton 1998).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.law_shear import shear
from garmentcad.fabric.law_tension import tension
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import OneLaw
from garmentcad.forces.shear import angle_and_lengths, shear_angle
from garmentcad.forces.tension_curves import tension_at, tension_curves


class BorderElements(NamedTuple):
    corners: np.ndarray  # (T,3) int32
    area: np.ndarray  # (T,) m2
    warp_gradient: np.ndarray  # (T,3) 1/m
    weft_gradient: np.ndarray  # (T,3) 1/m
    stiffness: np.ndarray  # (T,) G, N/m per rad
    patch: np.ndarray  # (T,3) int32
    patch_start: np.ndarray  # (K+1,) int32
    patch_triangle: np.ndarray  # (3T,) int32
    patch_area: np.ndarray  # (K,) m2, sum of the triangles' areas
    patch_curve: np.ndarray  # (K,2) int32 rows of the tension curves, warp and weft


@kernel
def _strains_of(items, border, positions, velocities, strains):  # type: ignore[no-untyped-def]
    x, v = positions, velocities
    for i in range(items[0], items[1]):
        for axis in range(2):
            gradient = border.warp_gradient if axis == 0 else border.weft_gradient
            ux = uy = uz = rx = ry = rz = 0.0
            for k in range(3):
                g, c = gradient[i, k], border.corners[i, k]
                ux, uy, uz = ux + g * x[c, 0], uy + g * x[c, 1], uz + g * x[c, 2]
                rx, ry, rz = rx + g * v[c, 0], ry + g * v[c, 1], rz + g * v[c, 2]
            length = math.sqrt(ux * ux + uy * uy + uz * uz)
            strains[i, axis] = length - 1.0
            strains[i, 2 + axis] = (ux * rx + uy * ry + uz * rz) / length if length > 0.0 else 0.0


@kernel
def _stresses_of(items, border, curves, damping_time, strains, stresses):  # type: ignore[no-untyped-def]
    for p in range(items[0], items[1]):
        for axis in range(2):
            strain = rate = 0.0
            for j in range(border.patch_start[p], border.patch_start[p + 1]):
                t = border.patch_triangle[j]
                strain += border.area[t] * strains[t, axis]
                rate += border.area[t] * strains[t, 2 + axis]
            r = border.patch_curve[p, axis]
            force = tension(strain / border.patch_area[p], curves.em[r], curves.fm[r], curves.exponent[r], curves.slope[r])[0]
            stresses[p, axis] = force + damping_time * curves.slope[r] * rate / border.patch_area[p]


@kernel
def _border_of(items, border, damping_time, positions, velocities, stresses, out):  # type: ignore[no-untyped-def]
    x, v = positions, velocities
    for i in range(items[0], items[1]):
        ux = uy = uz = wx = wy = wz = 0.0
        for k in range(3):
            g, h, c = border.warp_gradient[i, k], border.weft_gradient[i, k], border.corners[i, k]
            ux, uy, uz = ux + g * x[c, 0], uy + g * x[c, 1], uz + g * x[c, 2]
            wx, wy, wz = wx + h * x[c, 0], wy + h * x[c, 1], wz + h * x[c, 2]
        gamma, gux, guy, guz, gwx, gwy, gwz, _ = shear_angle(ux, uy, uz, wx, wy, wz)
        rate = 0.0
        for k in range(3):
            g, h, c = border.warp_gradient[i, k], border.weft_gradient[i, k], border.corners[i, k]
            rate += (g * gux + h * gwx) * v[c, 0] + (g * guy + h * gwy) * v[c, 1] + (g * guz + h * gwz) * v[c, 2]
        stress, tangent = shear(gamma, border.stiffness[i])
        shear_force = stress + damping_time * tangent * rate
        p, q, r = border.patch[i, 0], border.patch[i, 1], border.patch[i, 2]
        # |u| = 0 has no direction; its force is then zero because u is
        length = math.sqrt(ux * ux + uy * uy + uz * uz)
        warp = (stresses[p, 0] + stresses[q, 0] + stresses[r, 0]) / (3.0 * length if length > 0.0 else 1.0)
        length = math.sqrt(wx * wx + wy * wy + wz * wz)
        weft = (stresses[p, 1] + stresses[q, 1] + stresses[r, 1]) / (3.0 * length if length > 0.0 else 1.0)
        ux, uy, uz = warp * ux + shear_force * gux, warp * uy + shear_force * guy, warp * uz + shear_force * guz
        wx, wy, wz = weft * wx + shear_force * gwx, weft * wy + shear_force * gwy, weft * wz + shear_force * gwz
        for k in range(3):
            g, h = -border.area[i] * border.warp_gradient[i, k], -border.area[i] * border.weft_gradient[i, k]
            out[3 * i + k, 0], out[3 * i + k, 1], out[3 * i + k, 2] = g * ux + h * wx, g * uy + h * wy, g * uz + h * wz


@parallel_kernel
def _write_strains(border, positions, velocities, strains):  # type: ignore[no-untyped-def]
    for chunk in prange(CHUNKS):
        _strains_of(chunk_range(chunk, len(border.area)), border, positions, velocities, strains)


@parallel_kernel
def _write_stresses(border, curves, damping_time, strains, stresses):  # type: ignore[no-untyped-def]
    for chunk in prange(CHUNKS):
        _stresses_of(chunk_range(chunk, len(border.patch_area)), border, curves, damping_time, strains, stresses)


@parallel_kernel
def _write_corners(border, damping_time, positions, velocities, stresses, out):  # type: ignore[no-untyped-def]
    for chunk in prange(CHUNKS):
        _border_of(chunk_range(chunk, len(border.area)), border, damping_time, positions, velocities, stresses, out)


@kernel
def write_border(border, curves, damping_time, positions, velocities, strains, stresses, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of triangle i into out[3 i] to out[3 i + 2]. Three passes: triangle strains, patch stresses, triangle forces.

    strains (T,4): warp and weft strain of each triangle, then their rates; stresses (K,2): warp and weft of each patch. Both are scratch, and arguments of
    their own because numba drops writes into the arrays of a NamedTuple from a parallel kernel.
    """
    _write_strains(border, positions, velocities, strains)
    _write_stresses(border, curves, damping_time, strains, stresses)
    _write_corners(border, damping_time, positions, velocities, stresses, out)


class ForceBorder(OneLaw):
    """Stretch and shear of the border triangles of `cloth`. damping_time: tau [s]."""

    name = "border"

    def __init__(self, cloth: Cloth, materials: MaterialTable, damping_time: float = 0.0) -> None:
        border = cloth.border
        sizes = np.diff(border.patch_start)
        of_entry = np.repeat(np.arange(len(sizes)), sizes)
        self._border = BorderElements(
            np.array(border.corners),
            np.array(border.area),
            np.array(border.warp_gradient),
            np.array(border.weft_gradient),
            np.array(materials.shear[border.material]),
            np.array(border.patch),
            np.array(border.patch_start),
            np.array(border.patch_triangle),
            np.bincount(of_entry, weights=border.area[border.patch_triangle], minlength=len(sizes)),
            indices(2 * border.patch_material[:, None] + np.array([WARP, WEFT])),
        )
        self._of_entry = of_entry
        self._curves = tension_curves(materials)
        self._strains, self._stresses = np.zeros((len(border.area), 4)), np.zeros((len(sizes), 2))
        self.damping_time = damping_time
        self.corners = indices(border.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_border(self._border, self._curves, self.damping_time, positions, velocities, self._strains, self._stresses, out)

    def _vectors(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        corners = positions[self._border.corners]
        return np.einsum("tk,tkc->tc", self._border.warp_gradient, corners), np.einsum("tk,tkc->tc", self._border.weft_gradient, corners)

    def _patch_mean(self, values: np.ndarray) -> np.ndarray:
        """Area mean (K,) over each patch of one value per triangle (T,)."""
        border = self._border
        entries = (border.area * values)[border.patch_triangle]
        return np.bincount(self._of_entry, weights=entries, minlength=len(border.patch_area)) / border.patch_area

    def energy(self, positions: np.ndarray) -> float:
        warp, weft = self._vectors(positions)
        gamma, _, _ = angle_and_lengths(warp, weft)
        total = float(np.sum(0.5 * self._border.stiffness * gamma * gamma * self._border.area))
        for axis, vector in enumerate((warp, weft)):
            energy, _, _ = tension_at(self._curves, self._border.patch_curve[:, axis], self._patch_mean(np.linalg.norm(vector, axis=1) - 1.0))
            total += float(np.sum(energy * self._border.patch_area)) / 3.0
        return total

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        self._write_bound(*self._vectors(positions), out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` at rest, wherever the panels lie."""
        count = len(self._border.area)
        self._write_bound(np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1)), out)

    def _write_bound(self, warp: np.ndarray, weft: np.ndarray, out: np.ndarray) -> None:
        # shear as in shear.py; tension: |de_p/dx| by the triangle inequality along the fibre, and T/|u| across it, which only tension stiffens
        border = self._border
        gamma, warp_length, weft_length = angle_and_lengths(warp, weft)
        gradient = np.abs(border.warp_gradient) / warp_length[:, None] + np.abs(border.weft_gradient) / weft_length[:, None]
        bound = (border.stiffness * border.area * (1.0 + np.abs(gamma)))[:, None] * gradient * gradient.sum(axis=1, keepdims=True)
        for axis, vector, length, parts in ((WARP, warp, warp_length, border.warp_gradient), (WEFT, weft, weft_length, border.weft_gradient)):
            reach = np.abs(parts).sum(axis=1)
            _, force, tangent = tension_at(self._curves, border.patch_curve[:, axis], self._patch_mean(np.linalg.norm(vector, axis=1) - 1.0))
            along = (tangent * self._patch_mean(reach))[border.patch].mean(axis=1)
            across = np.maximum(force, 0.0)[border.patch].mean(axis=1) * reach / length
            bound += (border.area * (along + across))[:, None] * np.abs(parts)
        out[:] = bound.ravel()
