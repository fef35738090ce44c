"""Pictures of a draped garment, drawn on the processor. Pillow (extra `view`) is imported when the first picture is written, and not before."""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from garmentcad.arrays import floats, indices
from garmentcad.errors import GarmentError, InputError
from garmentcad.export import legend
from garmentcad.export.camera import Camera, frame
from garmentcad.export.color_map import PaintedMap, painted
from garmentcad.export.normals import particle_normals, split_at_creases
from garmentcad.export.raster import blank, draw_lines, draw_triangles
from garmentcad.export.seam_lines import SewnTriangles, seam_and_free_edges
from garmentcad.export.shading import shade
from garmentcad.export.sky_light import SkyLight, SurfaceLight
from garmentcad.io.atomic import write_atomic
from garmentcad.mannequin.mannequin import Mannequin

HEIGHT_PX = 1200
OVERSAMPLING = 2  # drawn larger and averaged down: the edges of folds stay clean
COMPRESSION = 2  # of the PNG: the highest takes six times as long and saves a quarter of the file


class Look(NamedTuple):
    """How strongly a surface is shaded. ambient: light without direction; diffuse: light of the lamps; darkest: what is left where no light comes in."""

    ambient: float
    diffuse: float
    darkest: float


BACKGROUND = ((0.965, 0.96, 0.95), (0.88, 0.88, 0.885))  # bottom, top
BODY = (0.80, 0.80, 0.81)
# Right sides of the cloth from the innermost layer outward, over and over; wrong sides are a little darker.
RIGHT_SIDES = ((0.88, 0.60, 0.46), (0.52, 0.63, 0.74), (0.66, 0.68, 0.50), (0.74, 0.58, 0.68))
WRONG_SIDE = 0.89
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
    cloth: SewnTriangles,
    mannequin: Mannequin | None,
    view: str = "front",
    map_name: str = "none",
    values: np.ndarray | None = None,
    height_px: int = HEIGHT_PX,
) -> Path:
    """Draw the garment at positions (P,3) m on its mannequin into a PNG file.

    view: front, back, left, right, three-quarter. map_name: none or a name of `color_map.MAPS`; values: (P,) one a particle, as in `Measures.maps`. Raises
    ViewMissing without the extra, InputError for an unknown view or map.
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
    cloth: SewnTriangles,
    mannequin: Mannequin | None,
    painted_map: PaintedMap | None = None,
    height_px: int = HEIGHT_PX,
) -> list[Path]:
    """As `render_picture`, for several views (view -> file) that share what does not depend on the camera."""
    room = 0 if painted_map is None else round(legend.WIDTH * height_px)
    cameras = [frame(view, positions, None if mannequin is None else mannequin.vertices, height_px, room) for view in paths]
    return [write_picture(path, picture) for path, picture in zip(paths.values(), draw_pictures(positions, cloth, mannequin, painted_map, cameras))]


def draw_pictures(
    positions: np.ndarray, cloth: SewnTriangles, mannequin: Mannequin | None, painted_map: PaintedMap | None, cameras: Sequence[Camera]
) -> list[Any]:
    """The garment as PIL images, one a camera. Raises ViewMissing without the extra."""
    image = _module("PIL.Image")
    scene = _scene(positions, cloth, mannequin, painted_map)

    def draw(camera: Camera) -> Any:
        picture = image.fromarray(_draw(scene, camera))
        if painted_map is not None:
            legend.draw_legend(picture, painted_map, camera.metres_a_pixel())
        return picture

    with ThreadPoolExecutor() as pool:
        return list(pool.map(draw, cameras))


def write_picture(path: str | Path, picture: Any) -> Path:
    """Write a PIL image as a PNG file."""
    buffer = io.BytesIO()
    picture.save(buffer, format="PNG", compress_level=COMPRESSION)
    return write_atomic(path, buffer.getvalue())


def body_pixels(mannequin: Mannequin, view: str = "front", height_px: int = HEIGHT_PX) -> np.ndarray:
    """The bare mannequin: pixels (height, width, 3) uint8. Raises InputError for an unknown view."""
    scene = _Scene((_body_surface(mannequin, SkyLight(mannequin.vertices, mannequin.faces)),), ())
    return _draw(scene, frame(view, mannequin.vertices, None, height_px))


def render_body(path: str | Path, mannequin: Mannequin, view: str = "front", height_px: int = HEIGHT_PX) -> Path:
    """Draw the bare mannequin into a PNG file; errors as in `render_picture`."""
    return write_picture(path, _module("PIL.Image").fromarray(body_pixels(mannequin, view, height_px)))


def _module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ViewMissing(f"pictures need an extra that is not installed: pip install garmentcad[view] ({error})") from error


@dataclass(frozen=True)
class _Surface:
    """One side of a surface: triangles counter-clockwise seen from that side, color (3,) or (N,3) in 0..1, light from the sky."""

    points: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    color: np.ndarray
    look: Look
    light: SurfaceLight


@dataclass(frozen=True)
class _Scene:
    surfaces: tuple[_Surface, ...]
    lines: tuple[tuple[np.ndarray, np.ndarray, tuple[float, float, float], float], ...]  # points, edges, color, width in pixels


def _scene(positions: np.ndarray, cloth: SewnTriangles, mannequin: Mannequin | None, painted_map: PaintedMap | None) -> _Scene:
    particle, triangles = split_at_creases(positions, cloth.particle_triangles)
    points = positions[particle]
    normals = particle_normals(points, triangles)
    # Where two layers are sewn together each has its own color up to the seam.
    (row, layer), corner = np.unique(np.stack([triangles.ravel(), np.repeat(cloth.triangle_layer, 3)]), axis=1, return_inverse=True)
    particle, points, normals, triangles = particle[row], points[row], normals[row], corner.reshape(-1, 3)
    layers = np.array(RIGHT_SIDES)[layer % len(RIGHT_SIDES)]
    right, wrong = (layers, WRONG_SIDE * layers) if painted_map is None else (painted_map.colors()[particle],) * 2
    look = CLOTH_LOOK if painted_map is None else MAP_LOOK
    if mannequin is None:
        sky = SkyLight(points, triangles)
    else:
        sky = SkyLight(np.vstack([points, mannequin.vertices]), np.vstack([triangles, mannequin.faces + len(points)]))
    surfaces = [
        _Surface(points, triangles, normals, right, look, sky.on(points, normals)),
        _Surface(points, triangles[:, ::-1], -normals, wrong, look, sky.on(points, -normals)),
    ]
    if mannequin is not None:
        surfaces.append(_body_surface(mannequin, sky))
    seams, free = seam_and_free_edges(cloth)
    return _Scene(tuple(surfaces), ((positions, free, HEM, HEM_PX), (positions, seams, SEAM, SEAM_PX)))


def _body_surface(mannequin: Mannequin, sky: SkyLight) -> _Surface:
    normals = particle_normals(mannequin.vertices, mannequin.faces)
    return _Surface(mannequin.vertices, mannequin.faces, normals, np.array(BODY), CLOTH_LOOK, sky.on(mannequin.vertices, normals))


def _draw(scene: _Scene, camera: Camera) -> np.ndarray:
    """Pixels (height, width, 3) uint8."""
    nearness, owner = blank(OVERSAMPLING * camera.height, OVERSAMPLING * camera.width)
    points, triangles, normals, colors, looks, corners = [], [], [], [], [], 0
    for surface in scene.surfaces:
        on_screen = camera.on_screen(surface.points, OVERSAMPLING)
        facing = surface.triangles[_faces_camera(on_screen, surface.triangles)]
        look = surface.look
        lit = look.darkest + (1.0 - look.darkest) * surface.light.seen(surface.triangles, camera.toward)
        points.append(on_screen)
        triangles.append(facing + corners)
        normals.append(surface.normals)
        colors.append(np.clip(surface.color * lit[:, None], 0.0, 1.0))
        looks.append(np.tile([look.ambient, look.diffuse], (len(facing), 1)))
        corners += len(on_screen)
    seen, shown = floats(np.concatenate(points)), indices(np.concatenate(triangles))
    draw_triangles(seen, shown, 0, nearness, owner)
    for k, (line_points, edges, _, width) in enumerate(scene.lines):
        radius_px = 0.5 * width * camera.height / HEIGHT_PX
        on_screen = camera.on_screen(line_points, OVERSAMPLING)
        draw_lines(on_screen, edges, OVERSAMPLING * radius_px, radius_px * camera.metres_a_pixel(), len(shown) + k, nearness, owner)
    pixels = np.empty((camera.height, camera.width, 3), dtype=np.uint8)
    flat = floats([color for _, _, color, _ in scene.lines]).reshape(-1, 3)
    shade(owner, seen, shown, floats(np.concatenate(normals)), floats(np.concatenate(colors)), floats(np.concatenate(looks)),
          _lamps(camera), flat, _background(camera.height), pixels)  # fmt: skip
    return pixels


def _faces_camera(on_screen: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(F,) bool: triangles in front of the camera whose corners turn counter-clockwise (rows grow downward)."""
    a, b, c = (on_screen[triangles[:, corner]] for corner in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return np.asarray((turn < 0.0) & (a[:, 2] > 0.0) & (b[:, 2] > 0.0) & (c[:, 2] > 0.0))


def _lamps(camera: Camera) -> np.ndarray:
    """(L,4) unit vectors to the lamps and their strengths; they turn with the camera."""
    lamps = []
    for (across, along, depth), intensity in LIGHTS:
        way = across * camera.right + along * camera.up + depth * camera.toward
        lamps.append([*(way / np.linalg.norm(way)), intensity])
    return floats(lamps)


def _background(height: int) -> np.ndarray:
    """(height,3) colors of the rows."""
    place = ((np.arange(height) + 0.5) / height)[:, None]
    return floats((1.0 - place) * np.array(BACKGROUND[1]) + place * np.array(BACKGROUND[0]))
