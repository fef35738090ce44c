"""Maps of a value over the garment: what is shown, in which unit, in which colors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.errors import InputError


@dataclass(frozen=True)
class MapKind:
    """title and unit of the legend; factor from the stored unit to the legend's; colors from low to high as (r, g, b) in 0..1, evenly spaced."""

    title: str
    unit: str
    factor: float
    colors: tuple[tuple[float, float, float], ...]


# Light where nothing happens, dark where much does; ordered in lightness, so they survive a grey printer and color-blind eyes.
_WARM = ((0.96, 0.94, 0.89), (0.97, 0.80, 0.55), (0.93, 0.55, 0.33), (0.78, 0.27, 0.27), (0.45, 0.09, 0.25))
_GREEN = ((0.20, 0.36, 0.25), (0.40, 0.60, 0.42), (0.68, 0.80, 0.60), (0.90, 0.92, 0.80), (0.97, 0.96, 0.92))
_COOL = ((0.95, 0.95, 0.92), (0.70, 0.85, 0.83), (0.36, 0.68, 0.72), (0.16, 0.44, 0.60), (0.11, 0.20, 0.42))
MAPS = {
    "strain": MapKind("strain along\nthe yarns", "%", 100.0, _WARM),
    "warp": MapKind("strain\nalong warp", "%", 100.0, _WARM),
    "weft": MapKind("strain\nalong weft", "%", 100.0, _WARM),
    "bias": MapKind("strain along\nthe bias", "%", 100.0, _WARM),
    "limit": MapKind("strain, of the\nfabric's limit", "%", 100.0, _WARM),
    "tension": MapKind("tension along\nthe yarns", "N/m", 1.0, _WARM),
    "pressure": MapKind("pressure\non the body", "kPa", 1.0, _COOL),
    "friction": MapKind("friction\non the body", "kPa", 1.0, _COOL),
    "apart": MapKind("distance\nfrom B", "mm", 1.0, _WARM),
    "distance": MapKind("distance\nfrom body", "mm", 1.0, _GREEN),
}
TOP_PERCENTILE = 99.5


@dataclass(frozen=True)
class PaintedMap:
    """A map ready to be drawn. values: (P,) in the legend's unit; low, high: ends of the legend."""

    kind: MapKind
    values: np.ndarray
    low: float
    high: float

    def colors(self) -> np.ndarray:
        """(P,3) colors in 0..1."""
        return self.colors_at((self.values - self.low) / (self.high - self.low))

    def colors_at(self, place: np.ndarray) -> np.ndarray:
        """Colors (N,3) at places (N,) of the legend, 0 is its low end and 1 its high one."""
        stops = np.array(self.kind.colors)
        return np.column_stack([np.interp(place, np.linspace(0.0, 1.0, len(stops)), stops[:, channel]) for channel in range(3)])


def painted(name: str, values: np.ndarray, high: float | None = None) -> PaintedMap:
    """Scale values (P,) of the map `name` for drawing: from 0 to a round number at their 99.5th percentile, or to `high` [legend's unit] where one is given
    (to compare garments). Raises InputError for an unknown map."""
    if name not in MAPS:
        raise InputError(f"no such map: {name!r}; allowed: none, {', '.join(MAPS)}", key="map")
    kind = MAPS[name]
    scaled = np.asarray(values, dtype=np.float64) * kind.factor
    top = float(np.percentile(scaled, TOP_PERCENTILE)) if len(scaled) else 0.0
    return PaintedMap(kind, scaled, 0.0, round_up(top) if high is None else high)


def round_up(value: float) -> float:
    """The next of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten; 1 for what is not positive."""
    if not value > 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next((step * power for step in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0) if step * power >= value * (1.0 - 1e-9)), 10.0 * power))
