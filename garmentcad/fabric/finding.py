"""Findings: what reading a fabric noticed and the reader should know. Nothing is corrected or assumed without one."""

from __future__ import annotations

from typing import Literal, NamedTuple

Severity = Literal["info", "warning"]


class Finding(NamedTuple):
    """severity: `info` (a rule that hardly matters), `warning` (an assumption or a strange value that may change the drape).

    key: dotted key of the sheet (`B.weft`), or the place in a CSV file; message: what was found, and what was assumed from what.
    """

    severity: Severity
    key: str
    message: str

    @property
    def said(self) -> str:
        """Place and message, where the severity goes without saying."""
        return f"{self.key}: {self.message}" if self.key else self.message

    def __str__(self) -> str:
        return f"{self.severity}: {self.said}"
