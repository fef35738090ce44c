"""NAME=NUMBER on the command line, and the options that stand for arguments of the library."""

from __future__ import annotations

import math
from collections.abc import Iterable

from garmentcad.errors import InputError

# What the library calls otherwise than the command line does.
_OPTIONS = {"grid_mm": "grid", "max_time_s": "max-time", "max_particles": "max-particles", "values": "set", "lines": "line", "map_name": "map"}
_SAME = {"fabric", "mannequin", "pose", "seed", "mode", "lays", "coarser", "case"}


def option_of(key: str | None, file: str | None) -> str | None:
    """A key as the command line has it: the option for an argument, `--set length` for `values.length`. What stands in a file keeps its key."""
    argument, _, part = (key or "").partition(".")
    if file is not None or argument not in _OPTIONS.keys() | _SAME:
        return key
    return " ".join(filter(None, [f"--{_OPTIONS.get(argument, argument)}", part]))


def by_option(error: InputError) -> InputError:
    """The error as the command line tells it."""
    return type(error)(error.message, file=error.file, key=option_of(error.key, error.file), others=error.others)


def named_numbers(words: Iterable[str] | None, option: str) -> dict[str, float]:
    """Numbers by name. InputError for what is not NAME=NUMBER, and for a name that stands twice."""
    found: dict[str, float] = {}
    for word in words or ():
        name, _, value = word.partition("=")
        if name in found:
            raise InputError(f"{name} stands twice, {found[name]:g} and {value}; each name may stand once", key=option)
        try:
            found[name] = float(value)
            if not name or not math.isfinite(found[name]):
                raise ValueError
        except ValueError:
            raise InputError(f"{word!r}; wanted is NAME=NUMBER", key=option) from None
    return found
