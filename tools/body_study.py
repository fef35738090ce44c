"""Every shipped mannequin as exported, against tape and judges that are not ours: docs/studies/mannequins.md, and the picture of all sizes.

`python -m tools.body_study`, a part of `make study`.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import igl
import ipctk
import numpy as np
import trimesh
from PIL import Image
from shapely.geometry import MultiPoint

from garmentcad.errors import MannequinError
from garmentcad.export.obj import write_mannequin_obj
from garmentcad.export.picture import body_pixels
from garmentcad.io.mannequin_file import mannequin_names, read_mannequin
from garmentcad.io.shipped import shipped_file
from garmentcad.io.yaml_file import read_yaml
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.sizes import full_sizes
from garmentcad.simulation.study import write_study_table

ROOT = Path(__file__).resolve().parent.parent
TAPED = ("bust", "waist", "hip", "neck_base", "top_arm", "wrist", "thigh", "stature")
LOOSE = ("shoulder", "armscye_depth")  # asked for, and not exact
TOLERANCE_MM = 2.0


def read_surface(path: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Vertices (V,3) m and faces (K,3) of each group of an OBJ file."""
    vertices: list[list[float]] = []
    groups: dict[str, list[list[int]]] = {}
    group: list[list[int]] = []
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "v":
            vertices.append([float(number) for number in rest])
        elif word == "g":
            group = groups.setdefault(rest[0], [])
        elif word == "f":
            group.append([int(number) - 1 for number in rest])
    return np.array(vertices), {name: np.array(faces) for name, faces in groups.items()}


def girth_mm(vertices: np.ndarray, faces: np.ndarray, origin: Any, normal: Any) -> float:
    """Perimeter of the convex hull of a section, by trimesh and shapely."""
    normal = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    lines = trimesh.intersections.mesh_plane(trimesh.Trimesh(vertices, faces, process=False), normal, origin)
    first = np.cross(normal, [0.3, 0.5, -0.7])
    first /= np.linalg.norm(first)
    return 1000.0 * MultiPoint(lines.reshape(-1, 3) @ np.stack([first, np.cross(normal, first)]).T).convex_hull.length


def taped_mm(path: Path, body: Mannequin) -> dict[str, float]:
    """Girths and stature of the surface in an OBJ file, taped on the right limbs in the planes that landmarks and heights of the body name."""
    vertices, parts = read_surface(path)
    marks, up = body.landmarks, [0.0, 1.0, 0.0]
    heights = {name: 1e-3 * body.measurements_mm[f"{name}_height"] for name in ("bust", "waist", "hip", "crotch")}
    found = {name: girth_mm(vertices, parts["torso"], [0.0, heights[name], 0.0], up) for name in ("bust", "waist", "hip")}
    across = np.cross(marks["neck_front"] - marks["nape"], [1.0, 0.0, 0.0])
    found["neck_base"] = girth_mm(vertices, np.vstack([parts["torso"], parts["head"]]), marks["nape"], across)
    shoulder = body.cylinders["arm_right"].origin
    upper, lower = marks["elbow_right"] - shoulder, marks["wrist_right"] - marks["elbow_right"]
    found["top_arm"] = girth_mm(vertices, parts["arm_right"], shoulder + 0.5 * upper, upper)
    found["wrist"] = girth_mm(vertices, parts["arm_right"], marks["wrist_right"], lower)
    found["thigh"] = girth_mm(vertices, parts["leg_right"], [0.0, heights["crotch"] - 0.02, 0.0], up)
    found["stature"] = 1000.0 * float(np.ptp(vertices[:, 1]))
    return found


def closed(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Watertight, turned outward, one piece without handles."""
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    return bool(mesh.is_watertight and mesh.is_winding_consistent and mesh.euler_number == 2 and mesh.volume > 0.0)


def crosses_itself(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether an edge passes through a face (ipctk)."""
    faces = np.asarray(faces, dtype=np.int32)
    return bool(ipctk.has_intersections(ipctk.CollisionMesh(vertices, ipctk.edges(faces), faces), vertices))


def asymmetry_mm(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Largest distance of a mirrored vertex from the surface (libigl)."""
    squared = igl.point_mesh_squared_distance(vertices * [-1.0, 1.0, 1.0], vertices, np.asarray(faces, dtype=np.int64))[0]
    return 1000.0 * float(np.sqrt(squared.max()))


def judged(body: Mannequin, asked: dict[str, float]) -> dict[str, Any]:
    """A row of the table: the body is written to an OBJ file and judged from there."""
    with tempfile.TemporaryDirectory() as folder:
        path = write_mannequin_obj(Path(folder) / "body.obj", body)
        found = taped_mm(path, body)
        vertices, parts = read_surface(path)
    faces = np.vstack(list(parts.values()))
    row: dict[str, Any] = {"name": body.name, "worst": max(abs(found[name] - asked[name]) for name in TAPED)}
    row |= {name: f"{asked[name]:.0f} / {found[name]:.1f}" for name in TAPED}
    row |= {name: f"{asked[name]:.0f} / {body.measurements_mm[name]:.0f}" for name in LOOSE}
    row |= {"closed": closed(vertices, faces), "crosses": crosses_itself(vertices, faces), "asymmetry": asymmetry_mm(vertices, faces)}
    return row


def contact_sheet(rows: list[tuple[list[Mannequin], str]], out: Path, height: int = 200) -> None:
    """A picture with a row of bodies for each view."""
    strips = [np.hstack([body_pixels(body, view, height) for body in bodies]) for bodies, view in rows]
    width = max(strip.shape[1] for strip in strips)
    around = [(width - strip.shape[1]) // 2 for strip in strips]
    strips = [np.pad(strip, ((0, 0), (room, width - strip.shape[1] - room), (0, 0)), mode="edge") for strip, room in zip(strips, around)]
    Image.fromarray(np.vstack(strips)).save(out, optimize=True)


def study() -> None:
    """Judge all sizes, write table and picture; MannequinError where one fails."""
    rows, bodies = [], []
    for name in mannequin_names():
        data, body = read_yaml(shipped_file("mannequins", name)), read_mannequin(name)
        rows.append(judged(body, full_sizes(data["kind"], data["measurements"])))
        bodies.append(body)
        print(name, f"worst {rows[-1]['worst']:.2f} mm", flush=True)
    columns = {"body": "name", "worst of the taped, mm": "worst:.2f"} | {f"{name.replace('_', ' ')}": name for name in (*TAPED, *LOOSE)}
    columns |= {"closed": "closed", "crosses itself": "crosses", "asymmetry mm": "asymmetry:.4f"}
    title = "Mannequins of all sizes: asked / found in mm on the exported OBJ, by trimesh, shapely, ipctk and libigl"
    write_study_table(ROOT / "docs" / "studies" / "mannequins.md", title, rows, columns, "make study")
    women, men = ([body for body in bodies if body.name.startswith(kind)] for kind in ("woman", "man"))
    contact_sheet([(women, "front"), (women, "left"), (men, "front"), (men, "left")], ROOT / "docs" / "pictures" / "mannequins.png")
    wrong = [row["name"] for row in rows if row["worst"] > TOLERANCE_MM or row["crosses"] or not row["closed"] or row["asymmetry"] > 0.1]
    if wrong:
        raise MannequinError(f"not as asked: {', '.join(wrong)}")


if __name__ == "__main__":
    study()
