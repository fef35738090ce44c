"""Strain of a draped garment along its yarns, measured on positions alone (nothing of the solver's bookkeeping is read).

Warp and weft strain e = length / rest length - 1 of every link and, in the border strip, |u| - 1 and |w| - 1 of every triangle's own warp and weft vector.
Bias strain alike, of both diagonals of every cell and of (w + u)/sqrt(2) and (w - u)/sqrt(2) of every border triangle.
Trellis angle: asin(u.w / (|u||w|)), the angle by which warp and weft have left the square. Percentiles and shares are weighted by the area of cloth
that an element stands for: link length x width, triangle and cell area.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable

AXES = ("warp", "weft")
TRELLIS_LIMIT_DEG = 8.0  # the end of the KES-FB1 shear test: beyond it the law is an extrapolation


@dataclass(frozen=True)
class YarnStrain:
    """Strain of E elements along one direction of the fabric.

    strain: (E,); area: (E,) m2; material: (E,) rows of the material table; particles: (E,3) int32 the element's particles (one of two repeats its second)
    and share: (E,3) the part of its area that goes to each of them.
    """

    strain: np.ndarray
    area: np.ndarray
    material: np.ndarray
    particles: np.ndarray
    share: np.ndarray


@dataclass(frozen=True)
class Trellis:
    """angle: (E,) rad of cells, then border triangles; area: (E,) m2."""

    angle: np.ndarray
    area: np.ndarray


def yarn_strain(cloth: Cloth, positions: np.ndarray, direction: int) -> YarnStrain:
    """Strain of all elements along `direction` (WARP or WEFT) at positions (P,3) m."""
    links, border = cloth.links, cloth.border
    mine = links.direction == direction
    ends, rest = links.ends[mine], links.rest_length[mine]
    length = np.linalg.norm(positions[ends[:, 1]] - positions[ends[:, 0]], axis=1)
    gradient = border.warp_gradient if direction == WARP else border.weft_gradient
    stretch = np.linalg.norm(_border_vector(cloth, positions, gradient), axis=1)
    return YarnStrain(
        strain=np.concatenate([length / rest - 1.0, stretch - 1.0]),
        area=np.concatenate([rest * links.width[mine], border.area]),
        material=np.concatenate([links.material[mine], border.material]),
        particles=np.concatenate([ends[:, [0, 1, 1]], border.corners]),
        share=_shares(len(ends), len(border.area)),
    )


def bias_strain(cloth: Cloth, positions: np.ndarray) -> tuple[YarnStrain, YarnStrain]:
    """Strain of all cells and border triangles along the two bias directions, at +45 and -45 degrees between weft and warp."""
    cells, border = cloth.cells, cloth.border
    warp, weft = (_border_vector(cloth, positions, gradient) for gradient in (border.warp_gradient, border.weft_gradient))
    found = []
    for a, b, sign in ((0, 2, 1.0), (3, 1, -1.0)):
        ends = cells.corners[:, [a, b]]
        diagonal = np.linalg.norm(positions[ends[:, 1]] - positions[ends[:, 0]], axis=1) / cells.spacing
        strip = np.linalg.norm(weft + sign * warp, axis=1)
        found.append(
            YarnStrain(
                strain=np.concatenate([diagonal, strip]) / np.sqrt(2.0) - 1.0,
                area=np.concatenate([cells.shear_area, border.area]),
                material=np.concatenate([cells.material, border.material]),
                particles=np.concatenate([ends[:, [0, 1, 1]], border.corners]),
                share=_shares(len(ends), len(border.area)),
            )
        )
    return found[0], found[1]


def trellis(cloth: Cloth, positions: np.ndarray) -> Trellis:
    """Trellis angles at positions (P,3) m: in a cell between its mean warp and mean weft direction, in a border triangle between its own two vectors."""
    x00, x10, x11, x01 = (positions[cloth.cells.corners[:, corner]] for corner in range(4))
    cell = _shear_angle(x01 + x11 - x00 - x10, x10 + x11 - x00 - x01)
    border = cloth.border
    strip = _shear_angle(_border_vector(cloth, positions, border.warp_gradient), _border_vector(cloth, positions, border.weft_gradient))
    return Trellis(np.concatenate([cell, strip]), np.concatenate([cloth.cells.shear_area, border.area]))


def strain_percentiles(*parts: YarnStrain) -> dict[str, float | None]:
    """{p50, p99, max, min} in percent of all parts together; None for a cloth without such elements."""
    strain, area = np.concatenate([part.strain for part in parts]), np.concatenate([part.area for part in parts])
    return {
        "p50": _percent(weighted_quantile(strain, area, 0.50)),
        "p99": _percent(weighted_quantile(strain, area, 0.99)),
        "max": _percent(strain.max() if len(strain) else None),
        "min": _percent(strain.min() if len(strain) else None),
    }


def trellis_summary(angles: Trellis) -> dict[str, float | None]:
    """{p99, max} of |angle| in degrees and over_8_percent, the percent of the cloth's area sheared by more than 8 degrees."""
    degrees = np.degrees(np.abs(angles.angle))
    return {
        "p99": weighted_quantile(degrees, angles.area, 0.99),
        "max": float(degrees.max()) if len(degrees) else None,
        "over_8_percent": _share(degrees > TRELLIS_LIMIT_DEG, angles.area),
    }


def share_of_limit(part: YarnStrain, direction: int, materials: MaterialTable) -> np.ndarray:
    """Strain over the fabric's own limit (E,) in `direction` (WARP or WEFT): 1 at the limit, the strain at 1.5 Fm; 0 for what is shorter than at rest."""
    return np.maximum(part.strain, 0.0) / materials.strain_limit[part.material, direction]


def of_limit_percent(warp: YarnStrain, weft: YarnStrain, materials: MaterialTable) -> dict[str, dict[str, float | None]]:
    """{warp, weft: {p99, max}} of `share_of_limit` in percent."""
    found = {}
    for axis, direction, part in zip(AXES, (WARP, WEFT), (warp, weft)):
        of_limit = share_of_limit(part, direction, materials)
        found[axis] = {"p99": _percent(weighted_quantile(of_limit, part.area, 0.99)), "max": _percent(of_limit.max() if len(of_limit) else None)}
    return found


def share_over_limit_percent(warp: YarnStrain, weft: YarnStrain, materials: MaterialTable) -> float | None:
    """Percent of the elements' area whose strain exceeds the fabric's strain limit (`MaterialTable.strain_limit`) in its direction."""
    over = [share_of_limit(part, axis, materials) > 1.0 for axis, part in ((WARP, warp), (WEFT, weft))]
    return _share(np.concatenate(over), np.concatenate([warp.area, weft.area]))


def element_panels(cloth: Cloth, part: YarnStrain) -> np.ndarray:
    """(E,) the panel of each element: particles on a seam lie on two panels, all of an element together on one."""
    count = len(cloth.panel_names)
    lies_on = np.bincount(cloth.vertex_particle * count + cloth.vertex_panel, minlength=cloth.particle_count * count).reshape(-1, count)
    return np.asarray(sum(lies_on[corner] for corner in part.particles.T).argmax(axis=1))


def particle_mean(part: YarnStrain, values: np.ndarray, particle_count: int) -> np.ndarray:
    """Area-weighted mean (P,) around each particle of one value an element (E,): what a map shows. 0 where a particle has no element."""
    weight = part.share * part.area[:, None]
    total = np.bincount(part.particles.ravel(), weights=weight.ravel(), minlength=particle_count)
    mean = np.bincount(part.particles.ravel(), weights=(weight * values[:, None]).ravel(), minlength=particle_count)
    return np.divide(mean, total, out=np.zeros(particle_count), where=total > 0.0)


def weighted_quantile(values: np.ndarray, weights: np.ndarray, fraction: float) -> float | None:
    """Smallest value below or at which `fraction` of the weight lies; None without values."""
    if len(values) == 0:
        return None
    order = np.argsort(values, kind="stable")
    cumulated = np.cumsum(weights[order])
    place = np.searchsorted(cumulated, fraction * cumulated[-1] * (1.0 - 1e-12))
    return float(values[order[min(place, len(values) - 1)]])


def _shares(pairs: int, triangles: int) -> np.ndarray:
    """`YarnStrain.share` of elements of two particles, then of three."""
    return np.concatenate([np.tile([0.5, 0.5, 0.0], (pairs, 1)), np.full((triangles, 3), 1.0 / 3.0)])


def _border_vector(cloth: Cloth, positions: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    return np.einsum("tk,tkd->td", gradient, positions[cloth.border.corners])


def _shear_angle(warp: np.ndarray, weft: np.ndarray) -> np.ndarray:
    product = np.linalg.norm(warp, axis=1) * np.linalg.norm(weft, axis=1)
    cosine = np.divide(np.einsum("ed,ed->e", warp, weft), product, out=np.zeros(len(product)), where=product > 0.0)
    return np.arcsin(np.clip(cosine, -1.0, 1.0))


def _share(mask: np.ndarray, area: np.ndarray) -> float | None:
    return float(100.0 * area[mask].sum() / area.sum()) if len(area) else None


def _percent(value: float | None) -> float | None:
    return None if value is None else 100.0 * float(value)
