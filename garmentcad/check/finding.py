"""What the pattern doctor finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Finding:
    """error: the garment cannot be sewn or simulated as it is meant; warning: it can, but hardly as meant; note: worth knowing.

    code: stable name of the kind of finding; file: the spec as the user wrote it; key: dotted path in it (elements of lists by their names);
    message: what was found, with numbers; remedy: what to do, empty where the message says what is allowed and there is no more to say.
    """

    severity: Severity
    code: str
    file: str | None
    key: str | None
    message: str
    remedy: str

    def __str__(self) -> str:
        where = ": ".join(part for part in (self.file, self.key) if part)
        said = " ".join(part for part in (f"{self.message}.", self.remedy, f"[{self.code}]") if part)
        return f"{self.severity}: {where}{': ' if where else ''}{said}"
