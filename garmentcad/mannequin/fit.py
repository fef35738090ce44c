"""The target weights whose body comes nearest to the measurements: Gauss-Newton least squares with analytic derivatives, priors and a trust box."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import lsq_linear

from garmentcad.mannequin.human import HumanModel, Shape, build_names, build_weights
from garmentcad.mannequin.stand import stand, wanted_heights
from garmentcad.mannequin.tapes import GIRTHS, taped
from garmentcad.units import MM_TO_M

_STEPS = 12
_FIRST_BOX = 0.3  # largest change of a parameter in one step; halved when a step does not help
_LAST_BOX = 0.02
_ROOM = 1e-9  # keeps the box of a parameter at its bound open
_SIGMA = {"neck_base": 0.006, "wrist": 0.004}  # m; what is left is corrected exactly afterwards
_GIRTH_SIGMA = 0.002  # m, the other girths
_LENGTH_SIGMA = 0.004  # m
_BUILD_SIGMA = 0.25  # muscle, weight around 1/2
_DIRECTION_SIGMA = 0.35  # measure directions around 0
_SHOULDER_RISE = 0.94  # horizontal share of the shoulder seam (cosine of its slope)
_HEIGHTS = ("napetowaist-dist", "waisttohip-dist", "neck-height", "upperleg-height", "lowerleg-height")  # standing sets heights


class _Space(NamedTuple):
    """What the parameters (muscle, weight, free directions) mean."""

    sizes: Mapping[str, float]
    builds: list[int]
    free: list[int]
    sigma: np.ndarray
    prior: np.ndarray


def fit_weights(model: HumanModel, sizes: Mapping[str, float]) -> np.ndarray:
    """Target weights (T,) for the measurements (full set, mm): girths of GIRTHS, arm length and shoulder width; muscle and weight are free in 0..1."""
    names = list(model.target_names)
    left_out = (*build_names("woman"), *build_names("man"), *_HEIGHTS, "firmness", *(("cup",) if model.kind == "man" else ()))
    free = [k for k, name in enumerate(names) if name not in left_out]
    sigma = np.r_[_BUILD_SIGMA, _BUILD_SIGMA, np.full(len(free), _DIRECTION_SIGMA)]
    prior = np.r_[0.5, 0.5, np.zeros(len(free))]
    space = _Space(sizes, [names.index(name) for name in build_names(model.kind)], free, sigma, prior)
    lowest = np.r_[0.0, 0.0, np.full(len(free), -1.0)]
    parameters, box = prior, _FIRST_BOX
    residuals, jacobian = _residuals(model, space, parameters)
    for _ in range(_STEPS):
        low, high = np.maximum(lowest - parameters, -box) - _ROOM, np.minimum(1.0 - parameters, box) + _ROOM
        trial = np.clip(parameters + lsq_linear(jacobian, -residuals, bounds=(low, high), method="bvls").x, lowest, 1.0)
        trial_residuals, trial_jacobian = _residuals(model, space, trial)
        if trial_residuals @ trial_residuals < residuals @ residuals:
            parameters, residuals, jacobian = trial, trial_residuals, trial_jacobian
        else:
            box *= 0.5
            if box < _LAST_BOX:
                break
    return _weights(model, space, parameters)


def _weights(model: HumanModel, space: _Space, parameters: np.ndarray) -> np.ndarray:
    weights = np.zeros(len(model.target_names))
    weights[space.builds] = build_weights(parameters[0], parameters[1])[0]
    weights[space.free] = parameters[2:]
    return weights


def _residuals(model: HumanModel, space: _Space, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals over their sigmas and the Jacobian by the parameters. The planes are held still in the derivatives (standing puts heights back)."""
    shape = model.shape(_weights(model, space, parameters))
    body, scale = stand(model, shape, space.sizes)
    heights = wanted_heights(model.kind, space.sizes)
    lowest, top = int(shape.points[:, 1].argmin()), model.landmarks["top"]
    growth = -scale * (model.targets[:, top, 1] - model.targets[:, lowest, 1]) / heights["stature"]  # of the scale, relative
    values, rows = [], []
    for name in GIRTHS:
        result = taped(name, model, body, heights)
        start, end, share, _ = result.section
        pull = scale * result.gradient
        by_target = np.einsum("k,kc,tkc->t", 1 - share, pull, model.targets[:, start]) + np.einsum("k,kc,tkc->t", share, pull, model.targets[:, end])
        sigma = _SIGMA.get(name, _GIRTH_SIGMA)
        values.append((result.girth - MM_TO_M * space.sizes[name]) / sigma)
        rows.append((by_target + growth * result.girth) / sigma)
    for value, by_target in _lengths(model, body, space.sizes, scale, growth):
        values.append(value / _LENGTH_SIGMA)
        rows.append(by_target / _LENGTH_SIGMA)
    _, by_muscle, by_weight = build_weights(parameters[0], parameters[1])
    by_targets = np.array(rows)
    by_build = by_targets[:, space.builds]
    jacobian = np.column_stack([by_build @ by_muscle, by_build @ by_weight, by_targets[:, space.free]])
    return np.r_[values, (parameters - space.prior) / space.sigma], np.vstack([jacobian, np.diag(1 / space.sigma)])


def _lengths(model: HumanModel, body: Shape, sizes: Mapping[str, float], scale: float, growth: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """Residuals (m) of arm length and half shoulder width with their derivatives by the targets (T,)."""
    tip = model.landmarks["shoulder_point"]
    index = {name: k for k, name in enumerate(model.joint_names)}
    shoulder, elbow, wrist = body.points[tip], body.joints["elbow"], body.joints["wrist"]
    upper, lower = elbow - shoulder, wrist - elbow
    length = np.linalg.norm(upper) + np.linalg.norm(lower)
    toward_elbow = model.joint_targets[:, index["elbow"]] - model.targets[:, tip]
    toward_wrist = model.joint_targets[:, index["wrist"]] - model.joint_targets[:, index["elbow"]]
    arm = scale * (toward_elbow @ upper / np.linalg.norm(upper) + toward_wrist @ lower / np.linalg.norm(lower))
    half = MM_TO_M * (sizes["neck_base"] / (2 * np.pi) + _SHOULDER_RISE * sizes["shoulder"])
    return [
        (float(length - MM_TO_M * sizes["arm_length"]), arm + growth * length),
        (float(shoulder[0] - half), scale * model.targets[:, tip, 0] + growth * shoulder[0]),
    ]
