"""Outfits: several garments on one mannequin, put on one after the other, inner to outer, and draped together as one pattern."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Literal, TypeVar

from pydantic import Field, PrivateAttr

from garmentcad.errors import SpecError
from garmentcad.pattern.model import Model
from garmentcad.pattern.pattern import Band, Button, EdgeUse, Panel, PanelPoint, Pattern, Pin, Seam
from garmentcad.pattern.spec import Name, Variable
from garmentcad.schema_version import SchemaVersion


class WornSpec(Model):
    """A garment of an outfit: a shipped name or a file; a fabric in place of its own; values of parameters in place of theirs."""

    garment: str
    fabric: str | None = None
    values: dict[Variable, Annotated[float, Field(strict=True)]] = {}


class OutfitSpec(Model):
    """Garments from the innermost to the outermost. What lies over another one at the waist is tucked over it: a shirt before a skirt is tucked into it."""

    schema_version: SchemaVersion = Field(default=1, alias="schema")
    units: Literal["mm"] = "mm"
    name: Name
    description: str = ""
    mannequin: str
    garments: list[WornSpec] = Field(min_length=2, max_length=6)

    _file: str | None = PrivateAttr(default=None)

    @property
    def file(self) -> str | None:
        """Path of the file it was read from, as the user wrote it."""
        return self._file


def put_on(name: str, patterns: Sequence[Pattern], mannequin: str) -> Pattern:
    """One pattern of several, inner to outer: names begin with the garment's, and every panel names its fabric.

    SpecError where two garments have one name.
    """
    names = [pattern.name for pattern in patterns]
    for twice in sorted({one for one in names if names.count(one) > 1}):
        raise SpecError(f"two garments are called {twice!r}; the panels of an outfit are told apart by the names of its garments", key="garments")
    panels: dict[str, Panel] = {}
    seams: list[Seam] = []
    pins: list[Pin] = []
    buttons: list[Button] = []
    bands: list[Band] = []
    for layer, pattern in enumerate(patterns):
        for panel in pattern.panels.values():
            own = _named(pattern, panel.name)
            panels[own] = replace(panel, name=own, fabric=panel.fabric or pattern.fabric, layer=layer)
        for seam in pattern.seams:
            a, b = (tuple(_moved(pattern, use) for use in side) for side in (seam.a, seam.b))
            tack = seam.tack and _moved(pattern, seam.tack)
            caught_in = seam.caught_in and _named(pattern, seam.caught_in)
            seams.append(replace(seam, name=_named(pattern, seam.name), a=a, b=b, tack=tack, caught_in=caught_in))
        pins += [replace(pin, name=_named(pattern, pin.name), at=_moved(pattern, pin.at)) for pin in pattern.pins]
        for button in pattern.buttons:
            buttons.append(Button(_named(pattern, button.name), _moved(pattern, button.button), _moved(pattern, button.buttonhole), button.order))
        for band in pattern.bands:
            lines = tuple(tuple(_moved(pattern, part) for part in line) for line in band.lines)
            bands.append(replace(band, name=_named(pattern, band.name), lines=lines))  # type: ignore[arg-type]
    values = {f"{pattern.name}.{key}": value for pattern in patterns for key, value in pattern.values.items()}
    return Pattern(name, panels, tuple(seams), patterns[0].fabric, mannequin, values, patterns[0].measurements_mm, tuple(pins), tuple(buttons), tuple(bands))


def below(pattern: Pattern) -> Pattern:
    """What is worn under the outermost garment of an outfit."""
    outermost = max(panel.layer for panel in pattern.panels.values())
    panels = {name: panel for name, panel in pattern.panels.items() if panel.layer < outermost}
    return replace(
        pattern,
        panels=panels,
        seams=tuple(seam for seam in pattern.seams if seam.a[0].panel in panels),
        pins=tuple(pin for pin in pattern.pins if pin.at.panel in panels),
        buttons=tuple(button for button in pattern.buttons if button.button.panel in panels),
        bands=tuple(band for band in pattern.bands if band.lines[0][0].panel in panels),
    )


_Part = TypeVar("_Part", bound=EdgeUse | PanelPoint)


def _moved(pattern: Pattern, part: _Part) -> _Part:
    """A part of an edge or a point on the panel of that name in the outfit."""
    return replace(part, panel=_named(pattern, part.panel))


def _named(pattern: Pattern, name: str) -> str:
    return f"{pattern.name}-{name}"
