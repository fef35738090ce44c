"""Workload W1 for other programs, and what each of them writes down. numpy only: it runs in their environments, without garmentcad.

SI; z is up and the ball's centre is the origin. The numbers are those of garmentcad/bench/cloth_on_ball.py, and a test holds them together.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

SIDE_M, RADIUS_M, START_M, GAP_M = 1.0, 0.25, 0.005, 0.003
AREAL_MASS_KG_M2, TENSION_N_M, SHEAR_N_M_RAD, BENDING_N_M, FRICTION = 0.15, 2000.0, 50.0, 1e-5, 0.3
GRAVITY_M_S2 = 9.81
JITTER_M = 1e-5
SIMULATED_S = 3.0


def options(about: str) -> argparse.Namespace:
    """What every peer's script is told: grid_mm, seconds, threads, out (a JSON file)."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--grid", dest="grid_mm", type=float, default=10.0, help="spacing of the cloth's particles, mm")
    parser.add_argument("--seconds", type=float, default=SIMULATED_S, help="simulated seconds")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="JSON file to write; positions go beside it")
    return parser.parse_args()


def square(grid_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Particles (n*n,3) m row by row, flat above the ball and a little uneven, and quads (Q,4) counter-clockwise from above."""
    count = round(1000.0 * SIDE_M / grid_mm) + 1
    side = np.linspace(-0.5 * SIDE_M, 0.5 * SIDE_M, count)
    x, y = np.meshgrid(side, side)
    z = RADIUS_M + START_M + JITTER_M * np.random.default_rng(0).standard_normal(x.shape)
    index = np.arange(count * count).reshape(count, count)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), quads


def triangles_of(quads: np.ndarray) -> np.ndarray:
    """(2Q,3), all diagonals alike."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def ball(around: int, down: int) -> tuple[np.ndarray, np.ndarray]:
    """The ball as a closed mesh of meridians and parallels: vertices (V,3) m, triangles (F,3) counter-clockwise from outside."""
    angles, heights = 2.0 * np.pi * np.arange(around) / around, np.pi * np.arange(1, down) / down
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    rings = [np.column_stack([np.sin(t) * ring, np.full(around, np.cos(t))]) for t in heights]
    vertices = RADIUS_M * np.concatenate([[[0.0, 0.0, 1.0]], *rings, [[0.0, 0.0, -1.0]]])
    here = 1 + np.arange(around * (down - 1)).reshape(down - 1, around)
    right = np.roll(here, -1, axis=1)
    a, b, c, d = here[:-1].ravel(), right[:-1].ravel(), here[1:].ravel(), right[1:].ravel()
    top = np.stack([np.zeros(around, int), here[0], right[0]], axis=-1)
    bottom = np.stack([np.full(around, len(vertices) - 1), right[-1], here[-1]], axis=-1)
    return vertices, np.concatenate([top, np.stack([a, c, d], axis=-1), np.stack([a, d, b], axis=-1), bottom])


class Recorder:
    """Clocks the work between frames and keeps the last two of them. What is done inside `frame` does not count."""

    def __init__(self) -> None:
        self.wall_s, self.cpu_s, self.time_s, self.speed_m_s = 0.0, 0.0, 0.0, 0.0
        self.positions: np.ndarray | None = None
        self.start()

    def start(self) -> None:
        """From now on the clocks run."""
        self._since, self._cpu_since = time.perf_counter(), time.process_time()

    def frame(self, time_s: float, positions: Any) -> None:
        """Positions (P,3) m at a simulated time."""
        self.wall_s += time.perf_counter() - self._since
        self.cpu_s += time.process_time() - self._cpu_since
        now = np.array(positions, dtype=np.float64).reshape(-1, 3)
        if self.positions is not None:
            self.speed_m_s = float(np.linalg.norm(now - self.positions, axis=1).max()) / (time_s - self.time_s)
        self.time_s, self.positions = time_s, now
        self.start()

    def write(self, out: Path, program: str, version: str, threads: int, settings: dict[str, Any]) -> None:
        """The run as JSON, and its last positions as OUT.npz. cpu_s: of all threads; largest_speed_m_s: of the fastest particle, from its way in the last
        frame."""
        assert self.positions is not None
        made = {
            "program": program,
            "version": version,
            "threads": threads,
            "settings": settings,
            "particles": len(self.positions),
            "simulated_s": self.time_s,
            "wall_s": self.wall_s,
            "cpu_s": self.cpu_s,
            "largest_speed_m_s": self.speed_m_s,
        }
        out.parent.mkdir(parents=True, exist_ok=True)
        np.savez(out.with_suffix(".npz"), positions=self.positions)
        out.write_text(json.dumps(made, indent=1) + "\n")
