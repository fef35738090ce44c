"""Closest points between points, segments and triangles, for kernels. Points are tuples (x, y, z); nothing here allocates.

Robust by construction: the inner solution is taken only where it is well conditioned and inside; otherwise the closest point lies on the border,
and the best of the border's parts wins. So degenerate triangles and segments give the right distance, too.
"""

from __future__ import annotations

import math

from garmentcad.arrays import entry, kernel

CORNER, EDGE, FACE = 0, 3, 6  # feature of a triangle: CORNER + 0..2, EDGE + 0..2 (ab, bc, ca), FACE
_FLAT = 1e-10  # squared sine below which a triangle or a pair of segments counts as degenerate (an angle of 1e-5)


@kernel
def row(points, index):  # type: ignore[no-untyped-def]
    """Row `index` of an (N,3) array as a tuple."""
    return points[index, 0], points[index, 1], points[index, 2]


@kernel
def minus(a, b):  # type: ignore[no-untyped-def]
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def along(a, b, t):  # type: ignore[no-untyped-def]
    """a + t b."""
    return a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]


@kernel
def dot(a, b):  # type: ignore[no-untyped-def]
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def distance_between(points, others, index):  # type: ignore[no-untyped-def]
    """Distance of the rows `index` of two (N,3) arrays."""
    way = minus(row(points, index), row(others, index))
    return math.sqrt(dot(way, way))


@kernel
def cross(a, b):  # type: ignore[no-untyped-def]
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def unit(a):  # type: ignore[no-untyped-def]
    """a / |a|, or the null vector."""
    length = math.sqrt(dot(a, a))
    if length == 0.0:
        return 0.0, 0.0, 0.0
    return a[0] / length, a[1] / length, a[2] / length


@kernel
def mixed(a, b, c, u, v, w):  # type: ignore[no-untyped-def]
    """u a + v b + w c."""
    return u * a[0] + v * b[0] + w * c[0], u * a[1] + v * b[1] + w * c[1], u * a[2] + v * b[2] + w * c[2]


@kernel
def point_segment(p, a, b):  # type: ignore[no-untyped-def]
    """Parameter t in [0, 1] of the point a + t (b - a) closest to p, and the squared distance."""
    ab, ap = minus(b, a), minus(p, a)
    length2 = dot(ab, ab)
    t = 0.0
    if length2 > 0.0:
        t = min(1.0, max(0.0, dot(ap, ab) / length2))
    gap = minus(ap, (t * ab[0], t * ab[1], t * ab[2]))
    return t, dot(gap, gap)


@kernel
def point_triangle(p, a, b, c):  # type: ignore[no-untyped-def]
    """Weights u, v, w of the point u a + v b + w c of the triangle closest to p, the squared distance, and the feature it lies on."""
    ab, ac, ap = minus(b, a), minus(c, a), minus(p, a)
    bb, bc, cc = dot(ab, ab), dot(ab, ac), dot(ac, ac)
    pb, pc = dot(ap, ab), dot(ap, ac)
    det = bb * cc - bc * bc
    if det > _FLAT * bb * cc:
        v, w = (cc * pb - bc * pc) / det, (bb * pc - bc * pb) / det
        if v > 0.0 and w > 0.0 and v + w < 1.0:
            q = minus(ap, (v * ab[0] + w * ac[0], v * ab[1] + w * ac[1], v * ab[2] + w * ac[2]))
            return 1.0 - v - w, v, w, dot(q, q), FACE
    t0, d0 = point_segment(p, a, b)
    t1, d1 = point_segment(p, b, c)
    t2, d2 = point_segment(p, c, a)
    if d0 <= d1 and d0 <= d2:
        feature = EDGE if 0.0 < t0 < 1.0 else (CORNER if t0 == 0.0 else CORNER + 1)
        return 1.0 - t0, t0, 0.0, d0, feature
    if d1 <= d2:
        feature = EDGE + 1 if 0.0 < t1 < 1.0 else (CORNER + 1 if t1 == 0.0 else CORNER + 2)
        return 0.0, 1.0 - t1, t1, d1, feature
    feature = EDGE + 2 if 0.0 < t2 < 1.0 else (CORNER + 2 if t2 == 0.0 else CORNER)
    return t2, 0.0, 1.0 - t2, d2, feature


@entry
@kernel
def closest_face(point, vertices, faces):  # type: ignore[no-untyped-def]
    """The face of a surface (V,3), (F,3) closest to a point (3,), the first of several, and the weights u, v, w of its corners at the closest point."""
    nearest, found = math.inf, (0, 1.0, 0.0, 0.0)
    p = point[0], point[1], point[2]
    for face in range(len(faces)):
        u, v, w, square, _ = point_triangle(p, row(vertices, faces[face, 0]), row(vertices, faces[face, 1]), row(vertices, faces[face, 2]))
        if square < nearest:
            nearest, found = square, (face, u, v, w)
    return found


@kernel
def segment_segment(a, b, c, d):  # type: ignore[no-untyped-def]
    """Parameters s, t in [0, 1] of the closest points a + s (b - a) and c + t (d - c), and the squared distance."""
    e, f, r = minus(b, a), minus(d, c), minus(a, c)
    ee, ff, ef = dot(e, e), dot(f, f), dot(e, f)
    er, fr = dot(e, r), dot(f, r)
    det = ee * ff - ef * ef
    if det > _FLAT * ee * ff:
        s, t = (ef * fr - ff * er) / det, (ee * fr - ef * er) / det
        if 0.0 < s < 1.0 and 0.0 < t < 1.0:
            q = (r[0] + s * e[0] - t * f[0], r[1] + s * e[1] - t * f[1], r[2] + s * e[2] - t * f[2])
            return s, t, dot(q, q)
    t, best = point_segment(a, c, d)
    s = 0.0
    t1, d1 = point_segment(b, c, d)
    if d1 < best:
        s, t, best = 1.0, t1, d1
    s2, d2 = point_segment(c, a, b)
    if d2 < best:
        s, t, best = s2, 0.0, d2
    s3, d3 = point_segment(d, a, b)
    if d3 < best:
        s, t, best = s3, 1.0, d3
    return s, t, best
