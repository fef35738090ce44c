"""How much of a fold pressing leaves: the share of the imposed curvature that the rest curvature takes on, by fibre.

All shares are estimates, set by how the trade presses the fibres; no source was found that measures a rest angle after a press. Wool sets in steam (its bonds
rearrange wet and hot), polyester above the temperature at which it softens; cotton and linen need water and keep less; silk is pressed dry and cool.
"""

from __future__ import annotations

SHARES: tuple[tuple[str, float], ...] = (("polyester", 0.9), ("wool", 0.85), ("linen", 0.75), ("cotton", 0.75), ("viscose", 0.75), ("silk", 0.7))
OTHER = 0.75


def pressed_share(fibre: str | None) -> float:
    """Share for the `fibre` entry of a sheet; of a blend the largest one, since the fibre that sets best holds the fold."""
    said = (fibre or "").lower()
    return max((share for name, share in SHARES if name in said), default=OTHER)
