"""Strain of a draped garment along its yarns, measured on positions alone (nothing of the solver's bookkeeping is read).

Warp and weft strain e = length / rest length - 1 of every link and, in the border strip, |u| - 1 and |w| - 1 of every triangle's own warp and weft vector.
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
    """Strain along one yarn direction of E elements (links, then border triangles).

    strain: (E,); area: (E,) m2; material: (E,) rows of the material table; particles: (E,3) int32 the element's particles (a link repeats its second
    end) and share: (E,3) the part of its area that goes to each of them.
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
        share=np.concatenate([np.tile([0.5, 0.5, 0.0], (len(ends), 1)), np.full((len(border.area), 3), 1.0 / 3.0)]),
    )


def trellis(cloth: Cloth, positions: np.ndarray) -> Trellis:
    """Trellis angles at positions (P,3) m: in a cell between its mean warp and mean weft direction, in a border triangle between its own two vectors."""
    x00, x10, x11, x01 = (positions[cloth.cells.corners[:, corner]] for corner in range(4))
    cell = _shear_angle(x01 + x11 - x00 - x10, x10 + x11 - x00 - x01)
    border = cloth.border
    strip = _shear_angle(_border_vector(cloth, positions, border.warp_gradient), _border_vector(cloth, positions, border.weft_gradient))
    return Trellis(np.concatenate([cell, strip]), np.concatenate([cloth.cells.shear_area, border.area]))


def strain_percentiles(strain: YarnStrain) -> dict[str, float | None]:
    """{p50, p99, max, min} in percent; None for a cloth without such elements."""
    return {
        "p50": _percent(weighted_quantile(strain.strain, strain.area, 0.50)),
        "p99": _percent(weighted_quantile(strain.strain, strain.area, 0.99)),
        "max": _percent(strain.strain.max() if len(strain.strain) else None),
        "min": _percent(strain.strain.min() if len(strain.strain) else None),
    }


def trellis_summary(angles: Trellis) -> dict[str, float | None]:
    """{p99, max} of |angle| in degrees and over_8_percent, the percent of the cloth's area sheared by more than 8 degrees."""
    degrees = np.degrees(np.abs(angles.angle))
    return {
        "p99": weighted_quantile(degrees, angles.area, 0.99),
        "max": float(degrees.max()) if len(degrees) else None,
        "over_8_percent": _share(degrees > TRELLIS_LIMIT_DEG, angles.area),
    }


def share_over_limit_percent(warp: YarnStrain, weft: YarnStrain, materials: MaterialTable) -> float | None:
    """Percent of the elements' area whose strain exceeds the fabric's strain limit (`MaterialTable.strain_limit`) in its direction."""
    over = [part.strain > materials.strain_limit[part.material, axis] for axis, part in ((WARP, warp), (WEFT, weft))]
    return _share(np.concatenate(over), np.concatenate([warp.area, weft.area]))


def particle_mean(part: YarnStrain, values: np.ndarray, particle_count: int) -> np.ndarray:
    """Area-weighted mean (P,) around each particle of one value an element (E,): what a map shows. 0 where a particle has no element."""
    weight = part.share * part.area[:, None]
    total = np.bincount(part.particles.ravel(), weights=weight.ravel(), minlength=particle_count)
    mean = np.bincount(part.particles.ravel(), weights=(weight * values[:, None]).ravel(), minlength=particle_count)
    return np.divide(mean, total, out=np.zeros(particle_count), where=total > 0.0)


def strain_map(cloth: Cloth, warp: YarnStrain, weft: YarnStrain) -> np.ndarray:
    """The larger of mean warp and mean weft strain around each particle (P,), no unit; negative where both are shorter than at rest."""
    return np.maximum(*(particle_mean(part, part.strain, cloth.particle_count) for part in (warp, weft)))


def weighted_quantile(values: np.ndarray, weights: np.ndarray, fraction: float) -> float | None:
    """Smallest value below or at which `fraction` of the weight lies; None without values."""
    if len(values) == 0:
        return None
    order = np.argsort(values, kind="stable")
    cumulated = np.cumsum(weights[order])
    place = np.searchsorted(cumulated, fraction * cumulated[-1] * (1.0 - 1e-12))
    return float(values[order[min(place, len(values) - 1)]])


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
