"""The version of the file formats, in the key `schema` of each."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator


def as_written(value: Any) -> Any:
    """In Python true is equal to 1; written out it is not."""
    return str(value).lower() if isinstance(value, bool) else value


SchemaVersion = Annotated[Literal[1], BeforeValidator(as_written)]
