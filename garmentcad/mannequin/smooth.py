"""Averaging of fields over a surface."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array


def averaging(faces: np.ndarray, count: int, border: int = 0) -> csr_array:
    """(count,count) matrix that puts the mean of its neighbours in the place of each vertex; faces (M,3).

    border: the surface is a half whose first `border` vertices lie in the mirror plane; there the mirrored neighbours count too (a component across the plane
    cancels, which is left to the caller).
    """
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    share = np.where(edges.max(axis=1) < border, 0.5, 1.0)  # an edge of the plane stands once for both halves
    ends, weight = np.vstack([edges, edges[:, ::-1]]).T, np.r_[share, share]
    adjacency = coo_array((weight, (ends[0], ends[1])), shape=(count, count)).tocsr()
    return csr_array(diags_array(1.0 / adjacency.sum(axis=1)) @ adjacency)
