"""Every error that garmentcad raises on purpose. The root is also a builtin, so that `except ValueError` works for bad input.

A message says what came, where (file and key path), and what is allowed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_SIZE = re.compile(r"(.*?)([0-9]{1,9})")


class GarmentError(Exception):
    """Root of all errors raised on purpose."""


class InputError(GarmentError, ValueError):
    """Something the user gave is refused.

    message: what came and what is allowed; file: path as the user wrote it; key: dotted key path inside the file; others: what else is wrong there, as far
    as it can be told apart.
    """

    def __init__(self, message: str, *, file: str | None = None, key: str | None = None, others: Sequence[InputError] = ()) -> None:
        self.message, self.file, self.key, self.others = message, file, key, tuple(others)
        where = ": ".join(part for part in (file, key) if part)
        more = f" (and {len(others)} more fault{'s' * (len(others) != 1)})" if others else ""
        super().__init__(f"{where}: {message}{more}" if where else message + more)


class SpecError(InputError):
    """A garment spec, or the pattern drafted from it, is refused."""


class ExpressionError(InputError):
    """An expression in a spec cannot be parsed or evaluated."""


class FabricError(InputError):
    """A KES sheet is refused."""


class MannequinError(InputError):
    """A mannequin, its measurements or a body scan is refused."""


class MeshError(InputError):
    """A mesh file is refused."""


class FileError(InputError):
    """A file cannot be read, is too large, or lies outside the folder that may refer to it."""


class LimitError(InputError):
    """The work asked for is larger than a cap; the message names the number and the cap."""


class TangledError(InputError):
    """A start position intersects itself or the mannequin; the message lists the pairs."""


class CheckpointError(InputError):
    """A checkpoint is torn, or belongs to another spec or version."""


def did_you_mean(word: str, allowed: Iterable[str]) -> str:
    """The end of a message about an unknown name: `; did you mean 'x'?` where one is close, then the names that are allowed (at most 40)."""
    names = sorted(set(allowed))  # an edge that is cut has its name in pieces
    near = [name for name in names if name.lower() == word.lower()] or get_close_matches(word[:100], names, n=1)
    if size := _SIZE.fullmatch(word[:100]):  # of sizes the next one, not the one that is spelt alike
        others = [(abs(int(other[2]) - int(size[2])), name) for name in names if (other := _SIZE.fullmatch(name)) and other[1] == size[1]]
        near = [min(others)[1]] if others else near
    listed = ", ".join(names[:40]) + (f", ... ({len(names)} in all)" if len(names) > 40 else "")
    return (f"; did you mean {near[0]!r}?" if near else ".") + (f" Allowed: {listed}" if names else " There are none to choose from")
