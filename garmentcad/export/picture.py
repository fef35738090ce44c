"""Offscreen pictures of a draped garment (extra `view`). VTK is imported when the first picture is drawn, and not before."""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import GarmentError, InputError
from garmentcad.export import legend
from garmentcad.export.camera import Camera, frame
from garmentcad.export.color_map import PaintedMap, painted
from garmentcad.export.normals import particle_normals
from garmentcad.export.seam_lines import polylines, seam_and_free_edges
from garmentcad.export.sky_light import SkyLight
from garmentcad.io.atomic import write_atomic
from garmentcad.mannequin.mannequin import Mannequin

HEIGHT_PX = 1200
OVERSAMPLING = 2  # drawn larger and averaged down: the edges of folds stay clean on any graphics driver


class Look(NamedTuple):
    """How strongly a surface is shaded. ambient: light without direction; diffuse: light of the lamps; darkest: what is left where no light comes in."""

    ambient: float
    diffuse: float
    darkest: float


BACKGROUND = ((0.965, 0.96, 0.95), (0.88, 0.88, 0.885))  # bottom, top
BODY = (0.80, 0.80, 0.81)
RIGHT_SIDE = (0.88, 0.60, 0.46)
WRONG_SIDE = (0.78, 0.54, 0.43)
SEAM = (0.27, 0.14, 0.09)
HEM = (0.42, 0.22, 0.14)
HEM_PX, SEAM_PX = 1.5, 2.0  # in a picture of HEIGHT_PX
CLOTH_LOOK = Look(ambient=0.28, diffuse=1.0, darkest=0.25)
MAP_LOOK = Look(ambient=0.58, diffuse=0.5, darkest=0.6)  # flatter, so that a color can be found in the legend
# Across, up and toward the camera, brightness: a key light high on the left, a fill on the right, a rim light from behind.
LIGHTS = (((-0.75, 0.75, 0.8), 0.72), ((0.9, 0.15, 0.8), 0.34), ((0.4, 0.9, -0.6), 0.25))


class ViewMissing(GarmentError):
    """The extra `view` is not installed."""


def render_picture(
    path: str | Path,
    positions: np.ndarray,
    cloth: Cloth,
    mannequin: Mannequin | None,
    view: str = "front",
    map_name: str = "none",
    values: np.ndarray | None = None,
    height_px: int = HEIGHT_PX,
) -> Path:
    """Draw the garment at positions (P,3) m on its mannequin into a PNG file.

    view: front, back, left, right, three-quarter. map_name: none, strain (values without unit), tension (N/m), pressure (kPa); values: (P,) one a particle,
    as in `Measures.maps`. Raises ViewMissing without the extra, InputError for an unknown view or map.
    """
    painted_map = None
    if map_name != "none":
        if values is None:
            raise InputError(f"there are no values for the map {map_name!r}", key="map")
        painted_map = painted(map_name, values)
    return render_pictures({view: Path(path)}, positions, cloth, mannequin, painted_map, height_px)[0]


def render_pictures(
    paths: Mapping[str, Path],
    positions: np.ndarray,
    cloth: Cloth,
    mannequin: Mannequin | None,
    painted_map: PaintedMap | None = None,
    height_px: int = HEIGHT_PX,
) -> list[Path]:
    """As `render_picture`, for several views (view -> file) that share what does not depend on the camera."""
    room = 0 if painted_map is None else round(legend.WIDTH * height_px)
    cameras = {view: frame(view, positions, None if mannequin is None else mannequin.vertices, height_px, room) for view in paths}
    pyvista, image = _module("pyvista"), _module("PIL.Image")
    pyvista.vtk_verbosity("off")  # without a screen VTK warns before it falls back to offscreen drawing
    scene = _scene(pyvista, positions, cloth, mannequin, painted_map)
    written = []
    for view, path in paths.items():
        picture = image.fromarray(_draw(pyvista, scene, cameras[view]))
        if painted_map is not None:
            legend.draw_legend(picture, painted_map)
        buffer = io.BytesIO()
        picture.save(buffer, format="PNG")
        written.append(write_atomic(path, buffer.getvalue()))
    return written


def _module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ViewMissing(f"pictures need an extra that is not installed: pip install garmentcad[view] ({error})") from error


@dataclass(frozen=True)
class _Surface:
    """One side of a surface: triangles counter-clockwise seen from that side, color (3,) or (N,3) in 0..1."""

    points: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    color: np.ndarray
    look: Look


@dataclass(frozen=True)
class _Scene:
    surfaces: tuple[_Surface, ...]
    lines: tuple[tuple[np.ndarray, np.ndarray, tuple[float, float, float], float], ...]  # points, edges, color, width in pixels
    sky: SkyLight


def _scene(pyvista: Any, positions: np.ndarray, cloth: Cloth, mannequin: Mannequin | None, painted_map: PaintedMap | None) -> _Scene:
    triangles = cloth.particle_triangles.astype(np.int64)
    normals = particle_normals(positions, triangles)
    right, wrong = (np.array(RIGHT_SIDE), np.array(WRONG_SIDE)) if painted_map is None else (painted_map.colors(),) * 2
    look = CLOTH_LOOK if painted_map is None else MAP_LOOK
    surfaces = [_Surface(positions, triangles, normals, right, look), _Surface(positions, triangles[:, ::-1], -normals, wrong, look)]
    shade_points, shade_triangles = positions, triangles
    if mannequin is not None:
        faces = mannequin.faces.astype(np.int64)
        surfaces.append(_Surface(mannequin.vertices, faces, particle_normals(mannequin.vertices, faces), np.array(BODY), CLOTH_LOOK))
        shade_points, shade_triangles = np.vstack([positions, mannequin.vertices]), np.vstack([triangles, faces + len(positions)])
    seams, free = seam_and_free_edges(cloth)
    lines = [(positions, edges, color, width) for edges, color, width in ((free, HEM, HEM_PX), (seams, SEAM, SEAM_PX)) if len(edges)]
    return _Scene(tuple(surfaces), tuple(lines), SkyLight(pyvista, shade_points, shade_triangles))


def _draw(pyvista: Any, scene: _Scene, camera: Camera) -> np.ndarray:
    """Pixels (height, width, 3) uint8."""
    size = (OVERSAMPLING * camera.width, OVERSAMPLING * camera.height)
    plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
    plotter.set_background(BACKGROUND[0], top=BACKGROUND[1])
    front = (camera.position - camera.focus) / np.linalg.norm(camera.position - camera.focus)
    _add_lights(pyvista, plotter, camera)
    for surface in scene.surfaces:
        seen = scene.sky.seen(surface.points, surface.normals, surface.triangles, front)
        _add_surface(pyvista, plotter, surface, seen)
    for points, edges, color, width in scene.lines:
        # Thin tubes, visible from both sides of the cloth: wide lines of graphics drivers have gaps.
        lines = np.concatenate([np.concatenate([[len(line)], line]) for line in polylines(edges)])
        radius = 0.5 * width * camera.height / HEIGHT_PX * camera.metres_a_pixel()
        tubes = pyvista.PolyData(points, lines=lines).tube(radius=radius, n_sides=6, capping=True)
        plotter.add_mesh(tubes, color=color, lighting=False)
    plotter.camera.position = tuple(camera.position)
    plotter.camera.focal_point = tuple(camera.focus)
    plotter.camera.up = (0.0, 1.0, 0.0)
    plotter.camera.view_angle = camera.view_angle_deg
    plotter.renderer.ResetCameraClippingRange()
    large = np.asarray(plotter.screenshot(return_img=True), dtype=np.uint16)
    plotter.close()
    large = large.reshape(camera.height, OVERSAMPLING, camera.width, OVERSAMPLING, 3)
    return (large.sum(axis=(1, 3)) // OVERSAMPLING**2).astype(np.uint8)


def _add_lights(pyvista: Any, plotter: Any, camera: Camera) -> None:
    """The lights turn with the camera."""
    toward = camera.position - camera.focus
    toward = toward / np.linalg.norm(toward)
    right = np.cross([0.0, 1.0, 0.0], toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    for (across, along, depth), intensity in LIGHTS:
        position = camera.focus + 10.0 * (across * right + along * up + depth * toward)
        plotter.add_light(pyvista.Light(position=tuple(position), focal_point=tuple(camera.focus), intensity=intensity))


def _add_surface(pyvista: Any, plotter: Any, surface: _Surface, seen: np.ndarray) -> None:
    mesh = pyvista.PolyData.from_regular_faces(surface.points, surface.triangles)
    mesh.point_data["Normals"] = surface.normals
    mesh.point_data.active_normals_name = "Normals"
    look = surface.look
    shade = look.darkest + (1.0 - look.darkest) * seen
    mesh.point_data["color"] = (255.0 * np.clip(surface.color * shade[:, None], 0.0, 1.0)).astype(np.uint8)
    plotter.add_mesh(
        mesh, scalars="color", rgb=True, smooth_shading=True, split_sharp_edges=False, ambient=look.ambient, diffuse=look.diffuse, specular=0.0, culling="back"
    )
