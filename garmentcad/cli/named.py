"""NAME=NUMBER on the command line."""

from __future__ import annotations

import math
from collections.abc import Iterable

from garmentcad.errors import InputError


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
