"""Fictitious inertia of drape mode: heavy where a particle is stiff, light across the cloth, where it is limp. The shape at rest does not depend on it.

    M = m_t (1 - n n^T) + m_t/u n n^T     u = REACH^2 min(1/s^2, k/b), 1 <= u <= MOST_LIGHTER

m_t: mass that resists along the cloth, raised from the true mass where the stable step of the particle is shorter than wanted; n: normal of the cloth at the
particle; s: largest sine of the slope against it of the sides that meet there; k, b: row sums of the stiffness there, of all forces and of what acts across
the cloth (bending, the pull of bands). The stable step is that of tension along the links. Across them only these, the pull of what is taut and s^2 k act,
hundreds of times less, and folds sway with that and all their mass. With u times less of it they sway up to sqrt(u) times faster, in steps as long as before.

A particle that touches something keeps one mass in all directions: impulses of contact know only one.

n is that of a moment ago. Cloth that has turned by an angle a since is moved along itself, where it is stiff, (u - 1) sin^2 a times more easily than the step
allows for. A fold that turned by three degrees rang: its particles flew to and fro from step to step, as fast as the speed cap let them.
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import entry, kernel

# Found by trial: on a settling skirt and on W1, at 10 mm, the highest frequency stays within 0.2 % up to here, and rises by 3 % (W1) with 0.7 for 0.5.
REACH = 0.5
MOST_LIGHTER = 64.0


@entry
@kernel
def normals_at(triangles, positions, normals):  # type: ignore[no-untyped-def]
    """Write unit normals (P,3) of the particles at positions (P,3) m, means over their triangles (T,3) by area."""
    normals[:] = 0.0
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        px, py, pz = positions[b, 0] - positions[a, 0], positions[b, 1] - positions[a, 1], positions[b, 2] - positions[a, 2]
        qx, qy, qz = positions[c, 0] - positions[a, 0], positions[c, 1] - positions[a, 1], positions[c, 2] - positions[a, 2]
        nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
        for p in (a, b, c):
            normals[p, 0], normals[p, 1], normals[p, 2] = normals[p, 0] + nx, normals[p, 1] + ny, normals[p, 2] + nz
    for p in range(len(normals)):
        size = math.sqrt(normals[p, 0] ** 2 + normals[p, 1] ** 2 + normals[p, 2] ** 2)
        for axis in range(3):
            normals[p, axis] = normals[p, axis] / size if size > 0.0 else 0.0


@entry
@kernel
def slopes(triangles, positions, normals, steepest):  # type: ignore[no-untyped-def]
    """Write the largest sine (P,) of the slope against their unit normals (P,3) of the sides of triangles (T,3) that meet at particles at positions (P,3) m."""
    steepest[:] = 0.0
    for t in range(len(triangles)):
        for side in range(3):
            a, b = triangles[t, side], triangles[t, (side + 1) % 3]
            x, y, z = positions[b, 0] - positions[a, 0], positions[b, 1] - positions[a, 1], positions[b, 2] - positions[a, 2]
            size = math.sqrt(x * x + y * y + z * z)
            for p in (a, b):
                rise = abs(x * normals[p, 0] + y * normals[p, 1] + z * normals[p, 2])
                steepest[p] = max(steepest[p], rise / size if size > 0.0 else 1.0)


def light_across(triangles: np.ndarray, positions: np.ndarray, limp: np.ndarray) -> np.ndarray:
    """sqrt(u - 1) n (P,3) at positions (P,3) of particles whose triangles are (T,3). limp (P,): how many times as stiff a particle is in all as across
    the cloth, 0 for one that keeps one mass in all directions."""
    normals, steepest = np.empty_like(positions), np.empty(len(positions))
    normals_at(triangles, positions, normals)
    slopes(triangles, positions, normals, steepest)
    lighter = np.clip(REACH**2 * np.minimum(1.0 / np.maximum(steepest, 1e-9) ** 2, limp), 1.0, MOST_LIGHTER)
    return np.sqrt(lighter - 1.0)[:, None] * normals


def turned(triangles: np.ndarray, positions: np.ndarray, across: np.ndarray) -> float:
    """Largest (u - 1) sin^2 a of the particles at positions (P,3) m; across: sqrt(u - 1) n (P,3) of a moment ago."""
    normals = np.empty_like(positions)
    normals_at(triangles, positions, normals)
    along = np.einsum("pc,pc->p", across, normals)
    return float((np.einsum("pc,pc->p", across, across) - along**2).max(initial=0.0))


def root_eased(vectors: np.ndarray, across: np.ndarray) -> np.ndarray:
    """(m_t M^-1)^(1/2) times vectors (P,3): 1 + (sqrt(u) - 1) n n^T; across: sqrt(u - 1) n (P,3)."""
    square = np.einsum("pc,pc->p", across, across)
    share = (np.sqrt(1.0 + square) - 1.0) / np.where(square > 0.0, square, 1.0)
    return np.asarray(vectors + (share * np.einsum("pc,pc->p", across, vectors))[:, None] * across)
