"""Eigenvalues and eigenvectors of many small symmetric matrices by Jacobi's rotations, to the same bits on every processor (see portable.py)."""

from __future__ import annotations

import numpy as np

_OFF = 1e-15  # of the largest number of a matrix: what may be left beside its diagonal
_SWEEPS = 30  # a handful suffices


def eigen(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (B,N), in no order, and the eigenvectors as columns of (B,N,N), of symmetric matrices (B,N,N), of which the lower triangles count.

    Meant for N below twenty or so: each rotation is one turn of a loop, over all matrices at once.
    """
    size = matrices.shape[1]
    lower = np.tril(matrices, -1)
    left = lower + lower.transpose(0, 2, 1) + np.einsum("bi,ij->bij", np.einsum("bii->bi", matrices), np.eye(size))
    vectors = np.zeros_like(left)
    vectors[:] = np.eye(size)
    for _ in range(_SWEEPS):
        if (np.abs(np.tril(left, -1)) <= _OFF * np.abs(left).max(axis=(1, 2), keepdims=True)).all():
            break
        for p in range(size):
            for q in range(p + 1, size):
                _rotate(left, vectors, p, q)
    return np.einsum("bii->bi", left).copy(), vectors


def _rotate(left: np.ndarray, vectors: np.ndarray, p: int, q: int) -> None:
    """Turn each matrix, in place, in the plane of p and q so that its entry there vanishes, and the vectors along."""
    between = left[:, p, q]
    turning = between != 0.0
    ratio = np.divide(left[:, q, q] - left[:, p, p], 2.0 * between, out=np.zeros_like(between), where=turning)
    tangent = np.where(turning, np.copysign(1.0, ratio) / (np.abs(ratio) + np.sqrt(ratio * ratio + 1.0)), 0.0)
    c = (1.0 / np.sqrt(tangent * tangent + 1.0))[:, None]
    s = tangent[:, None] * c
    for turned in (left, left.transpose(0, 2, 1), vectors.transpose(0, 2, 1)):
        a, b = turned[:, p].copy(), turned[:, q]
        turned[:, p], turned[:, q] = c * a - s * b, s * a + c * b
