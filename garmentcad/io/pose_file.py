"""Pose files: key frames of a body that moves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from garmentcad.errors import MannequinError, did_you_mean
from garmentcad.io.shipped import shipped_file
from garmentcad.io.yaml_file import read_yaml
from garmentcad.mannequin.motion import KeyFrame, Pose, allowed
from garmentcad.pattern.parse import shown
from garmentcad.schema_version import as_written

MAX_FRAMES, MAX_TIME_S = 200, 60.0
_TIME = f"more than 0 and at most {MAX_TIME_S:g} s are allowed"
_KEYS = {"schema", "description", "frames"}
_BOTH = {"arms": ("arm_left", "arm_right"), "hips": ("hip_left", "hip_right"), "knees": ("knee_left", "knee_right")}
_VALUES = {name: (name,) for names in _BOTH.values() for name in names} | _BOTH | {"turn": ("turn",), "ahead": ("ahead_mm",)}


def read_poses(name_or_path: str | Path) -> list[KeyFrame]:
    """The key frames of a shipped name (squat) or a YAML file. What a frame does not name stays as it was before; the body starts in its own pose.

    FileError or MannequinError (with file and key) when it is refused.
    """
    text = str(name_or_path)
    path = Path(text) if text.endswith((".yaml", ".yml")) else shipped_file("poses", text)
    data = read_yaml(path)
    if not isinstance(data, dict) or as_written(data.get("schema")) != 1 or not isinstance(data.get("frames"), list):
        raise MannequinError("a pose file is a mapping with `schema: 1` and a list `frames`", file=text)
    for key in data:
        if key not in _KEYS:
            raise MannequinError(f"{key!r} is not a key of a pose file{did_you_mean(str(key), _KEYS)}", file=text)
    if not 1 <= len(data["frames"]) <= MAX_FRAMES:
        raise MannequinError(f"{len(data['frames'])} frames; allowed: 1 to {MAX_FRAMES}", file=text, key="frames")
    found: list[KeyFrame] = []
    pose = Pose()
    for number, frame in enumerate(data["frames"]):
        key = f"frames.{number}"
        try:
            time, pose = _changed(pose, frame)
        except MannequinError as fault:
            raise MannequinError(fault.message, file=text, key=f"{key}.{fault.key}" if fault.key else key) from None
        if time <= (found[-1].time_s if found else 0.0):
            raise MannequinError(f"{time:g} s is not after the frame before it (the first one comes after 0 s)", file=text, key=f"{key}.time")
        found.append(KeyFrame(time, pose))
    return found


def _changed(pose: Pose, frame: Any) -> tuple[float, Pose]:
    """Time of a frame, and the pose that it makes of the one before it."""
    if not isinstance(frame, dict) or "time" not in frame:
        raise MannequinError("a frame is a mapping with `time` in s and what changes")
    by: dict[str, str] = {}
    for key, value in frame.items():
        if key != "time" and key not in _VALUES:
            raise MannequinError(f"{key!r} is not a part of a pose{did_you_mean(str(key), {'time', *_VALUES})}")
        parts = _VALUES.get(key, ())
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise MannequinError(f"{shown(value)} came; {allowed(parts[0]) if parts else _TIME}", key=key)
        for part in parts:
            if part in by:  # the order of keys would choose
                raise MannequinError(f"{part} is given by `{by[part]}`, too; once in a frame is allowed", key=key)
            by[part] = key
        try:
            pose = replace(pose, **dict.fromkeys(parts, float(value)))
        except MannequinError as fault:  # it names hip_left where the file says hips
            raise MannequinError(fault.message, key=key) from None
    if not 0.0 < frame["time"] <= MAX_TIME_S:
        raise MannequinError(f"{frame['time']:g} came; {_TIME}", key="time")
    return float(frame["time"]), pose
