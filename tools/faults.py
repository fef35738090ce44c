"""Faults put into plain data and into bytes by a seeded chance: what every study of untrusted input is made of."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from copy import deepcopy
from typing import Any

FACTORS = (1.0, 1.001, 0.98, 1.1, -1, 0, 100)


def nudge_numbers(data: Any, chance: random.Random, factors: Sequence[float] = FACTORS) -> None:
    """One to three numbers of the data times a factor, some plus or minus 1; in place."""
    for _ in range(chance.randint(1, 3)):
        *path, last = chance.choice([place for place in _places(data, []) if isinstance(_at(data, place), (int, float))])
        _at(data, path)[last] = _at(data, [*path, last]) * chance.choice(factors) + chance.choice([0, 0, 0, 0, 1, -1])


def with_faults(data: Any, chance: random.Random, odd: Sequence[Any], names: Sequence[str]) -> Any:
    """The data with up to two values dropped, doubled, moved, given another of the `names` as key, or replaced by one of `odd`."""
    for _ in range(chance.randint(0, 2)):
        data = _with_fault(data, chance, odd, names)
    return data


def with_changed_bytes(raw: bytes, chance: random.Random, pieces: Sequence[bytes]) -> bytes:
    """In one of three files, up to three places where bytes are cut out and one of the `pieces`, or nothing, is put in."""
    for _ in range(chance.randint(1, 3) if chance.random() < 0.33 else 0):
        where = chance.randrange(len(raw) + 1)
        raw = raw[:where] + chance.choice([b"", *pieces]) + raw[where + chance.choice([0, 0, 1, 2, 40]) :]
    return raw


def _with_fault(data: Any, chance: random.Random, odd: Sequence[Any], names: Sequence[str]) -> Any:
    places = list(_places(data, []))
    if not places:
        return chance.choice(odd)
    *path, last = chance.choice(places)
    holder = _at(data, path)
    kind = chance.randrange(6)
    if kind == 0:
        del holder[last]
    elif kind == 1:
        holder[last] = deepcopy(chance.choice(odd))
    elif kind == 2 and isinstance(holder, list):
        holder.insert(chance.randrange(len(holder) + 1), deepcopy(holder[last]))
    elif kind == 3 and isinstance(holder, dict):
        holder[chance.choice([*names, last + "_2", "päckchen"])] = holder.pop(last)
    else:
        holder[last] = deepcopy(_at(data, chance.choice(places)))
    return data


def _at(data: Any, path: list[Any]) -> Any:
    for key in path:
        data = data[key]
    return data


def _places(data: Any, path: list[Any]) -> Iterator[list[Any]]:
    rows = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in rows:
        yield [*path, key]
        yield from _places(value, [*path, key])
