"""One value a particle of everything that pictures paint on a garment."""

from __future__ import annotations

import numpy as np

from garmentcad.analysis.strain import bias_strain, particle_mean, share_of_limit, yarn_strain
from garmentcad.analysis.tension import carried_strain, tension_n_m
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable


def fabric_maps(cloth: Cloth, positions: np.ndarray, materials: MaterialTable) -> dict[str, np.ndarray]:
    """Maps (P,) of what the fabric bears at positions (P,3) m, means around each particle.

    warp, weft: strain; bias: the larger of the two bias directions; strain: the larger of warp and weft; limit: the larger of warp and weft as a part of the
    fabric's strain limit; tension: the larger of warp and weft, N/m. Strains have no unit, and are negative where the cloth is shorter than at rest.
    """
    count = cloth.particle_count
    yarns = {direction: yarn_strain(cloth, positions, direction) for direction in (WARP, WEFT)}
    warp, weft = (particle_mean(part, part.strain, count) for part in yarns.values())
    limit = [particle_mean(part, share_of_limit(part, direction, materials), count) for direction, part in yarns.items()]
    carried = {direction: carried_strain(cloth, positions, direction) for direction in yarns}
    tension = [particle_mean(part, tension_n_m(part.strain, part.material, materials, direction), count) for direction, part in carried.items()]
    return {
        "strain": np.maximum(warp, weft),
        "warp": warp,
        "weft": weft,
        "bias": np.maximum(*(particle_mean(part, part.strain, count) for part in bias_strain(cloth, positions))),
        "limit": np.maximum(*limit),
        "tension": np.maximum(*tension),
    }
