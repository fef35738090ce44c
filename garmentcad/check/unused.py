"""Parameters and values that nothing in the garment uses: a name that was mistyped, or is left over."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

from garmentcad.check.finding import Finding
from garmentcad.pattern.spec import GarmentSpec

_WORD = re.compile(r"[A-Za-z_]\w*")


def check_unused(spec: GarmentSpec) -> Iterator[Finding]:
    """A note for each; what only another unused one needs counts as used, so that one slip is told once, and so does what an edge or a point is called."""
    said = spec.model_dump(exclude={"description", "tests"})
    words = Counter(_words(said))
    for kind in ("parameters", "values"):
        for name, own in said[kind].items():
            if words[name] == Counter(_words(own))[name]:
                yield Finding(
                    "note", "name-unused", spec.file, f"{kind}.{name}", f"{name} is used nowhere: another number for it changes nothing",
                    "Use it in a point, an edge or another value, or leave it out.",
                )  # fmt: skip


def _words(node: Any) -> Iterator[str]:
    """All words in the texts below a node; names of keys and what they are called do not count as uses."""
    if isinstance(node, str):
        yield from _WORD.findall(node)
    elif isinstance(node, dict):
        for entry in node.values():
            yield from _words(entry)
    elif isinstance(node, list | tuple):
        for entry in node:
            yield from _words(entry)
