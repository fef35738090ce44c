"""Makes docs/pictures: swatches in a soft and a stiff fabric, and three garments in their own. `python -m tools.pictures`"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image
from trimesh.creation import icosphere

from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.export.drape import drape
from garmentcad.export.picture import render_picture
from garmentcad.fabric.material import material_row, material_table
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces, soften
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.simulation.course import Course
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "pictures"
FABRICS = ("silk-habotai", "cotton-broad")
GARMENTS = ("flared-skirt", "straight-skirt", "t-shirt")
HEIGHT_M = 1.0  # of what is hung or laid
BEND_M = 0.12


def ball(radius: float) -> Mannequin:
    """A ball whose top is at HEIGHT_M."""
    mesh = icosphere(subdivisions=4, radius=radius)
    faces = np.asarray(mesh.faces, dtype=np.int32)
    vertices = np.asarray(mesh.vertices) + np.array([0.0, HEIGHT_M - radius, 0.0])
    return Mannequin("ball", vertices, faces, {}, {}, {}, ("ball",), np.zeros(len(faces), dtype=np.int32))


def swatch(kind: str, fabric: str) -> Path:
    """Drape one swatch and draw it. kind: hung from two corners, on the bias from one corner, or laid on a ball of 120 mm."""
    materials = material_table([material_row(load_fabric(fabric_path(fabric)).sheet)])
    width, height = (460.0, 400.0) if kind == "ball" else (300.0, 300.0)
    cloth = rectangle_cloth(width, height, 10.0, 0.0, materials)
    flat = cloth.vertex_uv_mm * 1e-3 - [width * 5e-4, height * 5e-4]
    if kind == "ball":
        positions = np.column_stack([flat[:, 0], np.full(len(flat), HEIGHT_M + 0.003), -flat[:, 1]])
    else:
        turn = np.deg2rad(45.0 if kind == "bias" else 0.0)
        flat = flat @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        # bent around an upright cylinder, so that the held corners are closer than the cloth is wide and it falls into folds
        angle = flat[:, 0] / BEND_M
        positions = np.column_stack([BEND_M * np.sin(angle), flat[:, 1] + HEIGHT_M, BEND_M * np.cos(angle)])
    top = positions[:, 1].max()
    held = (positions[:, 1] > top - 1e-6) & ((np.abs(flat[:, 0]) > 0.149) | (kind == "bias")) if kind != "ball" else np.zeros(len(flat), dtype=bool)
    positions += 1e-5 * np.random.default_rng(0).standard_normal(positions.shape)
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses)])
    body = ball(0.06) if kind == "ball" else None
    contact = Contact(cloth, materials, None if body is None else (body.vertices, body.faces))
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), contact, held)
    state = State(positions, np.zeros_like(positions), phase="fall", run={"phase_from_s": 0.0})
    dynamics.start(state)
    status = Course(dynamics, partial(soften, forces.forces, cloth, materials), "drape", 15.0).run(state, lambda progress: None)
    print(kind, fabric, status, f"{state.time_s:.1f} s", flush=True)
    return render_picture(FOLDER / f"swatch-{kind}-{fabric}.png", state.positions, cloth, body, "three-quarter")


def side_by_side(pictures: list[Path], out: Path, height: int) -> None:
    """One row of pictures of equal height."""
    images = [Image.open(picture).convert("RGB") for picture in pictures]
    images = [image.resize((round(image.width * height / image.height), height), Image.Resampling.LANCZOS) for image in images]
    row = Image.new("RGB", (sum(image.width for image in images), height))
    for k, image in enumerate(images):
        row.paste(image, (sum(before.width for before in images[:k]), 0))
    row.save(out)


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for garment in GARMENTS:
        drape(garment, folder=ROOT / "out" / "pictures" / garment)
        (FOLDER / f"{garment}.png").write_bytes((ROOT / "out" / "pictures" / garment / "front.png").read_bytes())
    side_by_side([FOLDER / f"{garment}.png" for garment in GARMENTS], FOLDER / "garments.png", 700)
    side_by_side([swatch(kind, fabric) for kind in ("hung", "bias", "ball") for fabric in FABRICS], FOLDER / "swatches.png", 420)
