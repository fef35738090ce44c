"""The target weights whose body comes nearest to the measurements: Gauss-Newton least squares with analytic derivatives, priors and a trust box."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import lsq_linear

from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.human import HumanModel, Shape, build_names, build_weights
from garmentcad.mannequin.mannequin import SHOULDER_RISE
from garmentcad.mannequin.stand import stand, wanted_heights
from garmentcad.mannequin.tapes import taped
from garmentcad.units import MM_TO_M

_STEPS = 12
_FIRST_BOX = 0.3  # largest change of a parameter in one step; halved when a step does not help
_LAST_BOX = 0.02
_DECIMALS = 6  # of parameters: a body is the same to the bit whatever processor solved for it, whose linear algebra differs in the last bits
_ROOM = 1e-9  # keeps the box of a parameter at its bound open
_LENGTH_SIGMA = 0.004  # m


class Space(NamedTuple):
    """What the parameters (muscle, weight, free directions) mean, how far they go, and what counts."""

    free: list[int]  # targets
    lowest: np.ndarray
    highest: np.ndarray
    prior: np.ndarray  # the start too
    sigma: np.ndarray  # of the parameters around the prior
    held: np.ndarray  # (T,) weights of the other targets
    girth_sigma: Mapping[str, float]  # m; what is left of the girths is corrected exactly afterwards


def fit(model: HumanModel, space: Space, sizes: Mapping[str, float]) -> np.ndarray:
    """Parameters whose body comes nearest to the measurements (full set, mm): the girths of the space, arm length and shoulder width."""
    parameters, box = space.prior, _FIRST_BOX
    residuals, jacobian = _residuals(model, space, sizes, parameters)
    for _ in range(_STEPS):
        low, high = np.maximum(space.lowest - parameters, -box) - _ROOM, np.minimum(space.highest - parameters, box) + _ROOM
        step = lsq_linear(jacobian, -residuals, bounds=(low, high), method="bvls").x
        trial = np.clip(np.round(parameters + step, _DECIMALS), space.lowest, space.highest)
        trial_residuals, trial_jacobian = _residuals(model, space, sizes, trial)
        if norm(trial_residuals) < norm(residuals):
            parameters, residuals, jacobian = trial, trial_residuals, trial_jacobian
        else:
            box *= 0.5
            if box < _LAST_BOX:
                break
    return parameters


def target_weights(model: HumanModel, space: Space, parameters: np.ndarray) -> np.ndarray:
    """(T,) weights of all targets."""
    weights = space.held.copy()
    weights[_builds(model)] = build_weights(parameters[0], parameters[1])[0]
    weights[space.free] = parameters[2:]
    return weights


def _builds(model: HumanModel) -> list[int]:
    return [model.target_names.index(name) for name in build_names(model.kind)]


def _residuals(model: HumanModel, space: Space, sizes: Mapping[str, float], parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals over their sigmas and the Jacobian by the parameters. The planes are held still in the derivatives (standing puts heights back)."""
    shape = model.shape(target_weights(model, space, parameters))
    body, scale = stand(model, shape, sizes)
    heights = wanted_heights(model.kind, sizes)
    lowest, top = int(shape.points[:, 1].argmin()), model.landmarks["top"]
    growth = -scale * (model.targets[:, top, 1] - model.targets[:, lowest, 1]) / heights["stature"]  # of the scale, relative
    values, rows = [], []
    for name, sigma in space.girth_sigma.items():
        result = taped(name, model, body, heights)
        start, end, share, _ = result.section
        pull = scale * result.gradient
        by_target = np.einsum("k,kc,tkc->t", 1 - share, pull, model.targets[:, start]) + np.einsum("k,kc,tkc->t", share, pull, model.targets[:, end])
        values.append((result.girth - MM_TO_M * sizes[name]) / sigma)
        rows.append((by_target + growth * result.girth) / sigma)
    for value, by_target in _lengths(model, body, sizes, scale, growth):
        values.append(value / _LENGTH_SIGMA)
        rows.append(by_target / _LENGTH_SIGMA)
    _, by_muscle, by_weight = build_weights(parameters[0], parameters[1])
    by_targets = np.array(rows)
    by_build = by_targets[:, _builds(model)]
    jacobian = np.column_stack([product(by_build, by_muscle), product(by_build, by_weight), by_targets[:, space.free]])
    return np.r_[values, (parameters - space.prior) / space.sigma], np.vstack([jacobian, np.diag(1 / space.sigma)])


def _lengths(model: HumanModel, body: Shape, sizes: Mapping[str, float], scale: float, growth: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """Residuals (m) of arm length and half shoulder width with their derivatives by the targets (T,)."""
    tip = model.landmarks["shoulder_point"]
    index = {name: k for k, name in enumerate(model.joint_names)}
    shoulder, elbow, wrist = body.points[tip], body.joints["elbow"], body.joints["wrist"]
    upper, lower = elbow - shoulder, wrist - elbow
    length = norm(upper) + norm(lower)
    toward_elbow = model.joint_targets[:, index["elbow"]] - model.targets[:, tip]
    toward_wrist = model.joint_targets[:, index["wrist"]] - model.joint_targets[:, index["elbow"]]
    arm = scale * (product(toward_elbow, upper) / norm(upper) + product(toward_wrist, lower) / norm(lower))
    half = MM_TO_M * (sizes["neck_base"] / (2 * np.pi) + SHOULDER_RISE * sizes["shoulder"])
    return [
        (float(length - MM_TO_M * sizes["arm_length"]), arm + growth * length),
        (float(shoulder[0] - half), scale * model.targets[:, tip, 0] + growth * shoulder[0]),
    ]
