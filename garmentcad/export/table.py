"""Tables for the terminal that show text as it came: to rich, what stands in square brackets in a plain string is markup, and a lab's `[gf/cm]` vanishes."""

from __future__ import annotations

from typing import Any

from rich.table import Table
from rich.text import Text


class PlainTable(Table):
    """A table whose title, headings and cells are text; `Text` where a cell has a style. options: those of rich's table."""

    def __init__(self, title: str | None = None, **options: Any) -> None:
        super().__init__(title=None if title is None else Text(title, style="table.title"), title_justify="left", **options)

    def add_column(self, header: Any = "", *args: Any, **options: Any) -> None:
        super().add_column(_as_text(header), *args, **options)

    def add_row(self, *cells: Any, **options: Any) -> None:
        super().add_row(*(_as_text(cell) for cell in cells), **options)


def _as_text(cell: Any) -> Any:
    return Text(cell) if isinstance(cell, str) else cell
