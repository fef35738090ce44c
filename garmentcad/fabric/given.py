"""A number as a file holds it: a reading, or a value of the sheet that was measured otherwise."""

from __future__ import annotations

from typing import NamedTuple


class Given(NamedTuple):
    """value: in the unit of its quantity; file: as the user wrote it; line: from 1; source: who measured it, where the file says so."""

    value: float
    file: str
    line: int
    source: str = ""
