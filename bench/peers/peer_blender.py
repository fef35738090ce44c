"""W1 in Blender's cloth, through its Python module `bpy`.

Blender's cloth counts in frames: gravity adds 0.001 g metres per frame squared whatever the frame rate, so a simulated second is sqrt(1000) frames. Only the
ratios of stiffness and drag to mass matter. At 10 mm a vertex gets the 0.3 kg of Blender's presets for our 15 mg; spring stiffness is the setting over the
mean edge length, so that 15 (cotton) is 75 N/m and 400 is 2000 N/m. Quality 10 with collision quality 3 is the cheapest setting that ended without crossings.
"""

from __future__ import annotations

import math
import os

import bpy
import numpy as np
from workload import GAP_M, GRAVITY_M_S2, Recorder, ball, options, square

FRAMES_PER_S = math.sqrt(1000.0)
QUALITY, COLLISION_QUALITY = 10, 3
MASS_AT_10_MM = 0.3
CLOTH = {
    "tension_stiffness": 400.0, "compression_stiffness": 400.0, "shear_stiffness": 15.0, "bending_stiffness": 0.5,
    "tension_damping": 5.0, "compression_damping": 5.0, "shear_damping": 5.0, "bending_damping": 0.5, "air_damping": 1.0,
}  # fmt: skip
FRICTION = 5.0  # Blender's own scale and its default


def mesh_object(name: str, vertices: np.ndarray, faces: np.ndarray) -> bpy.types.Object:
    """A new object in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def positions(cloth: bpy.types.Object) -> np.ndarray:
    """Of the cloth at the scene's frame, (P,3) m; asking for them is what makes Blender simulate the frame."""
    mesh = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat


given = options(__doc__)
scene = bpy.context.scene
for old in list(bpy.data.objects):
    bpy.data.objects.remove(old)
scene.render.threads_mode, scene.render.threads = "FIXED", given.threads
scene.gravity = (0.0, 0.0, -GRAVITY_M_S2)
frames = math.ceil(given.seconds * FRAMES_PER_S)
scene.frame_start, scene.frame_end = 1, frames + 1

cloth = mesh_object("cloth", *square(given.grid_mm))
body = mesh_object("ball", *ball(64, 32))
body.modifiers.new("collision", "COLLISION")
body.collision.thickness_outer, body.collision.thickness_inner = GAP_M, 0.02
body.collision.cloth_friction, body.collision.damping = FRICTION, 0.1

modifier = cloth.modifiers.new("cloth", "CLOTH")
modifier.point_cache.frame_start, modifier.point_cache.frame_end = 1, frames + 1
cloth_settings, contact = modifier.settings, modifier.collision_settings
cloth_settings.quality, cloth_settings.time_scale = QUALITY, 1.0
cloth_settings.mass = MASS_AT_10_MM * (given.grid_mm / 10.0) ** 2
for name, value in CLOTH.items():
    setattr(cloth_settings, name, value)
contact.use_collision, contact.distance_min, contact.collision_quality, contact.friction = True, GAP_M, COLLISION_QUALITY, FRICTION
contact.use_self_collision, contact.self_distance_min, contact.self_friction = True, GAP_M, FRICTION

scene.frame_set(1)
positions(cloth)
recorder = Recorder()
recorder.start()
for frame in range(1, frames + 1):
    scene.frame_set(frame + 1)
    recorder.frame(frame / FRAMES_PER_S, positions(cloth))
settings = {"quality": QUALITY, "collision_quality": COLLISION_QUALITY, "frames": frames, "mass": cloth_settings.mass, **CLOTH}
recorder.write(given.out, "Blender", bpy.app.version_string, given.threads, settings)
os._exit(0)  # the module's own clean-up may crash at exit
