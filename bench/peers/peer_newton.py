"""W1 in NVIDIA Newton on the CPU, with its Style3D cloth: the one of its solvers whose tension and shear are separate, as in W1.

Settings follow Newton's own Style3D example. It runs on one thread; kernels are compiled in a first frame that does not count.
"""

from __future__ import annotations

import os

os.environ["CUDA_VISIBLE_DEVICES"] = ""  # before warp looks for one

import newton
import warp as wp
from newton.solvers import SolverStyle3D, style3d
from workload import AREAL_MASS_KG_M2, BENDING_N_M, FRICTION, GAP_M, GRAVITY_M_S2, RADIUS_M, SHEAR_N_M_RAD, TENSION_N_M, Recorder, options, square, triangles_of

FRAMES_PER_S, SUBSTEPS, ITERATIONS = 60, 8, 10
CONTACT_N_M, CONTACT_DAMPING = 5e3, 1e-5

given = options(__doc__)
wp.config.quiet = True
wp.init()
wp.set_device("cpu")
points, quads = square(given.grid_mm)
builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
SolverStyle3D.register_custom_attributes(builder)
shape = builder.default_shape_cfg.copy()
shape.mu, shape.ke, shape.kd = FRICTION, CONTACT_N_M, CONTACT_DAMPING
builder.add_shape_sphere(-1, radius=RADIUS_M, cfg=shape)
style3d.add_cloth_mesh(
    builder,
    pos=wp.vec3(0.0, 0.0, 0.0), rot=wp.quat_identity(), vel=wp.vec3(0.0, 0.0, 0.0), scale=1.0,
    vertices=[wp.vec3(*point) for point in points], indices=triangles_of(quads).ravel().tolist(),
    density=AREAL_MASS_KG_M2, particle_radius=GAP_M,
    tri_aniso_ke=wp.vec3(TENSION_N_M, TENSION_N_M, SHEAR_N_M_RAD), edge_aniso_ke=wp.vec3(BENDING_N_M, BENDING_N_M, BENDING_N_M),
)  # fmt: skip
model = builder.finalize(device="cpu")
model.set_gravity((0.0, 0.0, -GRAVITY_M_S2))
model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = CONTACT_N_M, CONTACT_DAMPING, FRICTION
solver = SolverStyle3D(model, config=SolverStyle3D.Config(iterations=ITERATIONS))
solver.collision.radius = GAP_M
pipeline = newton.CollisionPipeline(model, soft_contact_gap=0.01)
contacts, control = pipeline.contacts(), model.control()
now, then = model.state(), model.state()


def advance() -> None:
    """One frame; `now` holds its end."""
    global now, then
    solver.rebuild_bvh(now)
    for _ in range(SUBSTEPS):
        now.clear_forces()
        pipeline.collide(now, contacts)
        solver.step(now, then, control, contacts, 1.0 / FRAMES_PER_S / SUBSTEPS)
        now, then = then, now


start = now.particle_q.numpy().copy()
advance()
now.particle_q.assign(start)
now.particle_qd.zero_()
recorder = Recorder()
recorder.start()
for frame in range(1, round(given.seconds * FRAMES_PER_S) + 1):
    advance()
    recorder.frame(frame / FRAMES_PER_S, now.particle_q.numpy())
settings = {"solver": "Style3D", "frames_per_s": FRAMES_PER_S, "substeps": SUBSTEPS, "iterations": ITERATIONS}
recorder.write(given.out, "Newton", newton.__version__, 1, settings)
