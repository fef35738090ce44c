"""GarmentCode files drawn for tests and studies: plain data as `json` has it, in centimetres, y up, +x the wearer's left; and faults put into them."""

from __future__ import annotations

import json
import random
from copy import deepcopy
from pathlib import Path
from typing import Any

from tools.faults import nudge_numbers, with_changed_bytes, with_faults

Data = dict[str, Any]


def pattern_file(panels: Data, stitches: list[Any] = [], **properties: Any) -> Data:  # noqa: B006
    """A whole file around panels and stitches."""
    known = {"curvature_coords": "relative", "normalize_panel_translation": False, "normalized_edge_loops": True, "units_in_meter": 100}
    return {"pattern": {"panels": panels, "stitches": stitches}, "parameters": {}, "parameter_order": [], "properties": known | properties}


def panel(*vertices: tuple[float, float], at: tuple[float, float, float] = (0, 0, 0), turned: tuple[float, float, float] = (0, 0, 0), **curves: Any) -> Data:
    """A panel whose edges join its vertices in order; curves: e3=curvature of edge 3, or label3=its label."""
    edges: list[Data] = [{"endpoints": [k, (k + 1) % len(vertices)]} for k in range(len(vertices))]
    for name, value in curves.items():
        if name.startswith("e"):
            edges[int(name[1:])]["curvature"] = value
        elif name != "label":
            edges[int(name[5:])]["label"] = value
    made = {"translation": list(at), "rotation": list(turned), "vertices": [list(vertex) for vertex in vertices], "edges": edges}
    return made | ({"label": curves["label"]} if "label" in curves else {})


def stitch(panel_a: str, edge_a: int, panel_b: str, edge_b: int, *more: str) -> list[Any]:
    return [{"panel": panel_a, "edge": edge_a}, {"panel": panel_b, "edge": edge_b}, *more]


def circle(radius: float, large: int, right: int) -> Data:
    return {"type": "circle", "params": [radius, large, right]}


def skirt() -> Data:
    """A straight band and a flared skirt: front and back each, the front of the skirt gathered into the band; back panels run clockwise in the file."""
    return pattern_file(
        {
            "wb_front": panel((0, 0), (45, 0), (45, 4), (0, 4), at=(-22.5, 104, 18), label="body"),
            "wb_back": panel((0, 0), (0, 4), (45, 4), (45, 0), at=(-22.5, 104, -14), label="body"),
            "skirt_front": panel((0, 0), (80, 0), (67.5, 50), (12.5, 50), at=(-40, 50, 20), label="leg", e0=circle(120, 0, 1)),
            "skirt_back": panel((0, 0), (12.5, 50), (57.5, 50), (70, 0), at=(-35, 50, -16), label="leg"),
        },
        [
            stitch("wb_front", 1, "wb_back", 2),
            stitch("wb_front", 3, "wb_back", 0),
            stitch("skirt_front", 1, "skirt_back", 2),
            stitch("skirt_front", 3, "skirt_back", 0),
            stitch("wb_front", 0, "skirt_front", 2),
            stitch("wb_back", 3, "skirt_back", 1),
        ],
    )


def bodice() -> Data:
    """Left and right fronts that touch in the middle, a back, a dart, curves of every kind, a sleeve turned with the arm, and a lapel sewn right on wrong."""
    cubic = {"type": "cubic", "params": [[0.2, -0.3], [0.6, -0.25]]}
    front = [(0, 0), (12, 0), (14, 9), (16, 0), (28, 0), (28, 28), (17, 47), (11, 49), (0, 34)]
    return pattern_file(
        {
            "left_front": panel(
                *front, at=(0, 92, 28), label="body", e5={"type": "cubic", "params": [[0.2, 0.3], [0.6, 0.25]]}, e7=circle(14, 0, 0), label7="left_collar",
            ),
            "right_front": panel(
                *[(-x, y) for x, y in [front[0], *front[:0:-1]]],
                at=(0, 92, 28), label="body", e1=circle(14, 0, 0), label1="right_collar", e3={"type": "cubic", "params": [[0.4, 0.25], [0.8, 0.3]]},
            ),
            "back": panel(
                (-28, 0), (-28, 29), (-17, 48), (-11, 50), (11, 50), (17, 48), (28, 29), (28, 0), at=(0, 92, -24), label="body", e1=cubic, e3=[0.5, -0.3],
            ),
            "left_sleeve": panel((0, 0), (22, 0), (22, -12), (0, -14), at=(40, 126, 16), turned=(0, 0, -45.5), label="arm"),
            "lapel": panel((0, 0), (-7, 0), (-7, -20), at=(14, 160, 34), e2={"type": "quadratic", "params": [[0.7, -0.2]]}),
        },
        [
            stitch("left_front", 8, "right_front", 0),
            stitch("left_front", 4, "back", 6),
            stitch("right_front", 4, "back", 0),
            stitch("left_front", 6, "back", 4),
            stitch("right_front", 2, "back", 2),
            stitch("left_front", 1, "left_front", 2),
            stitch("right_front", 7, "right_front", 6),
            stitch("lapel", 1, "left_front", 7, "right_wrong"),
        ],
    )  # fmt: skip


def old_shirt() -> Data:
    """As the forerunner of GarmentCode wrote them: 300 units in a metre, bare pairs, no word on edge loops, parameters."""
    data = pattern_file(
        {
            "front": panel((-60, 0), (60, 0), (60, 150), (-60, 150), at=(0, 300, 80), e0=[0.5, -0.1]),
            "back": panel((-60, 0), (60, 0), (60, 150), (-60, 150), at=(0, 300, -80), turned=(0, 180, 0)),
        },
        [stitch("front", 1, "back", 3), stitch("front", 3, "back", 1)],
        units_in_meter=300,
    )
    del data["properties"]["normalized_edge_loops"]
    data["parameters"] = {"length": {"value": 1, "range": [0.5, 2], "type": "length", "influence": []}}
    return data


ALL = {"skirt": skirt, "bodice": bodice, "old_shirt": old_shirt}
_ODD = [None, True, False, 0, 1, -1, 0.5, -1e9, 1e300, 10**25, "", "x", "right_wrong", "\ud83d\ude00", [], {}, [[]], [0, 1], {"type": "circle"}, {"panel": "x"}]
_TEXT = [b"{", b"}", b"[", b"]", b'"', b",", b":", b"NaN", b"-Infinity", b"1e999", b"\\", b"\x00", b"\xff", b"[" * 40, b'"panel":', b"9" * 5000]


def mutated(seed: int) -> bytes:
    """Bytes of a file with faults: numbers nudged, then in two of three files values replaced, moved, dropped or doubled, in one of three bytes changed."""
    chance = random.Random(seed)
    data: Any = deepcopy(ALL[chance.choice(sorted(ALL))]())
    nudge_numbers(data, chance)
    return with_changed_bytes(json.dumps(with_faults(data, chance, _ODD, ("units", "type", "label"))).encode(), chance, _TEXT)


def write(data: Any, folder: Path, name: str = "garment.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(data))
    return path
