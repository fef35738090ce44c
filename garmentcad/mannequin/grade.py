"""Bodies of all sizes: the base size of a kind is fitted with every direction of the data, the others are graded from it, as a tailor grades a pattern.

Directions and builds of the data draw edges across back and belly where they go far. So a grade takes them as smooth fields (each averaged over neighbours)
added to the standing base body, keeps the muscle and carries the weight on beyond the heaviest shape of the data; what is missing in girth is left to the exact
correction.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from garmentcad.mannequin.fit import Space, fit, target_weights
from garmentcad.mannequin.human import HumanModel, Shape, build_names
from garmentcad.mannequin.sizes import base_sizes
from garmentcad.mannequin.smooth import averaging
from garmentcad.mannequin.stand import stand
from garmentcad.mannequin.tapes import GIRTHS

_HEIGHTS = ("napetowaist-dist", "waisttohip-dist", "neck-height", "upperleg-height", "lowerleg-height")  # standing sets heights
_BASE_GIRTH_SIGMA = dict.fromkeys(GIRTHS, 0.002) | {"neck_base": 0.006, "wrist": 0.004}  # m
_BASE_BUILD_SIGMA = 0.25  # muscle, weight around 1/2
_BASE_DIRECTION_SIGMA = 0.35  # measure directions around 0
_GRADE_GIRTH_SIGMA = dict.fromkeys(("bust", "waist", "hip", "thigh", "top_arm", "neck_base"), 0.010)  # m
_HEAVIEST = 1.4  # weight
_WEIGHT_SIGMA, _DIRECTION_SIGMA = 0.5, 0.35  # around the base
# Largest weights of the directions that a grade uses; those that it does not use keep the base's.
_REACH = {"cup": 0.4, "bust-circ": 0.6, "waist-circ": 0.6, "hips-circ": 0.6, "thigh-circ": 0.4, "upperarm-circ": 0.6, "neck-circ": 1.0, "shoulder-dist": 1.0,
          "upperarm-length": 1.0, "lowerarm-length": 1.0}  # fmt: skip
_SMOOTHING = 200  # times half-way to the mean of the neighbours


def standing_body(model: HumanModel, sizes: Mapping[str, float]) -> Shape:
    """The body of measurements (full set, mm) with its heights in place and its girths near."""
    if dict(sizes) == base_sizes(model.kind):
        return _base(model).body
    graded, space = _grade(model)
    found = fit(graded, space, sizes)
    return stand(graded, graded.shape(target_weights(model, space, found)), sizes)[0]


class _Base(NamedTuple):
    """The standing base body, its scale to the data, the weights of the directions that it has, the free ones among them, and its muscle and weight."""

    body: Shape
    scale: float
    weights: np.ndarray
    free: list[int]
    build: tuple[float, float]


@lru_cache(maxsize=2)
def _base(model: HumanModel) -> _Base:
    names = list(model.target_names)
    left_out = (*build_names("woman"), *build_names("man"), *_HEIGHTS, "firmness", *(("cup",) if model.kind == "man" else ()))
    free = [k for k, name in enumerate(names) if name not in left_out]
    space = Space(
        free,
        lowest=np.r_[0.0, 0.0, np.full(len(free), -1.0)],
        highest=np.ones(2 + len(free)),
        prior=np.r_[0.5, 0.5, np.zeros(len(free))],
        sigma=np.r_[_BASE_BUILD_SIGMA, _BASE_BUILD_SIGMA, np.full(len(free), _BASE_DIRECTION_SIGMA)],
        held=np.zeros(len(names)),
        girth_sigma=_BASE_GIRTH_SIGMA,
    )
    sizes = base_sizes(model.kind)
    found = fit(model, space, sizes)
    weights = target_weights(model, space, found)
    body, scale = stand(model, model.shape(weights), sizes)
    return _Base(body, scale, weights, free, (found[0], found[1]))


@lru_cache(maxsize=2)
def _grade(model: HumanModel) -> tuple[HumanModel, Space]:
    """The model whose base shape is the standing base body, with smooth targets, and how a grade may change it."""
    body, scale, weights, free, (muscle, weight) = _base(model)
    names = model.target_names
    targets, joint_targets = scale * _smooth(model), scale * model.joint_targets
    joints = np.array([body.joints[name] for name in model.joint_names]) - np.einsum("t,tjk->jk", weights, joint_targets)
    graded = replace(model, base=body.points - np.einsum("t,tnk->nk", weights, targets), targets=targets, joints=joints, joint_targets=joint_targets)
    used = [k for k in free if names[k] in _REACH]
    reach = np.array([_REACH[names[k]] for k in used])
    space = Space(
        used,
        lowest=np.r_[muscle, 0.0, np.minimum(-reach, weights[used])],
        highest=np.r_[muscle, _HEAVIEST, np.maximum(reach, weights[used])],
        prior=np.r_[muscle, weight, weights[used]],
        sigma=np.r_[1.0, _WEIGHT_SIGMA, np.full(len(used), _DIRECTION_SIGMA)],
        held=weights,
        girth_sigma=_GRADE_GIRTH_SIGMA,
    )
    return graded, space


def _smooth(model: HumanModel) -> np.ndarray:
    """(T,N,3) targets averaged over neighbours; the middle line takes the mirrored half into account."""
    count = len(model.base)
    average = averaging(model.faces, count, model.border)
    fields = np.ascontiguousarray(np.moveaxis(model.targets, 0, 1)).reshape(count, -1)
    for _ in range(_SMOOTHING):
        fields = 0.5 * (fields + average @ fields)
        fields[: model.border, ::3] = 0.0  # mirrored, x cancels there
    return np.moveaxis(fields.reshape(count, -1, 3), 1, 0)
