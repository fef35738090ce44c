"""Names within a panel: what darts, pleats and the mirror add bears names of its own."""

from __future__ import annotations

from collections.abc import Collection

from garmentcad.errors import SpecError
from garmentcad.pattern.pattern import Panel
from garmentcad.pattern.pleats import FOLD, UNDER
from garmentcad.pattern.spec import PanelSpec

SUFFIX = "_m"  # of what the mirror adds


def check_made(spec: PanelSpec, panel: Panel, key: str) -> None:
    """SpecError where a dart or a pleat makes something that is called as another thing of its kind, or a drill hole is called as a point.

    panel: that of the spec, cut, before it is unfolded.
    """
    for name in spec.drill_holes:
        if name in spec.points:
            raise SpecError(f"a point is called {name!r} too; pins and buttons name points and drill holes alike: rename one", key=f"{key}.drill_holes.{name}")
    taken = {("edge", edge.name): "an edge" for edge in spec.edges} | {("fold", fold.name): "a fold" for fold in spec.folds}
    taken |= {("point", name): "a point" for name in spec.points} | {("point", name): "a drill hole" for name in spec.drill_holes}
    makers: list[tuple[str, str, str, tuple[str, ...]]] = []
    makers += [("dart", dart.name, f"{key}.darts.{k}.name", ("_a", "_apex", "_b")) for k, dart in enumerate(spec.darts)]
    number = {pleats.name: k for k, pleats in enumerate(spec.pleats)}
    for fold in panel.folds:
        if fold.laid and fold.name.endswith(FOLD):
            name = fold.name.removesuffix(FOLD)
            makers.append(("pleat", name, f"{key}.pleats.{number[name.rpartition('_')[0]]}.name", ("_a", FOLD, UNDER, "_b")))
    for maker, name, where, ends in makers:
        made = [("seam", name), ("edge", f"{name}_leg_a"), ("edge", f"{name}_leg_b"), *(("point", name + end) for end in ends)]
        made += [("fold", name + end) for end in (FOLD, UNDER) if maker == "pleat"]
        for kind in made:
            if kind in taken:
                what = "an edge" if kind[0] == "edge" else f"a {kind[0]}"
                raise SpecError(f"{maker} {name!r} makes {what} {kind[1]!r}, and {taken[kind]} is called so, too; rename one", key=where)
            taken[kind] = f"that of {maker} {name!r}"


def check_images(half: Panel, own_points: Collection[str], own_folds: Collection[str], key: str) -> None:
    """SpecError where the image of something would be called as another thing of its kind.

    half: without its mirror edge; own_points, own_folds: what is its own image and keeps its name.
    """
    edges = [edge for loop in (half.edges, *half.holes) for edge in loop]
    kinds: dict[str, set[str]] = {
        "edge": {edge.name for edge in edges},
        "dart or pleat": {edge.dart for edge in edges if edge.dart is not None},
        "point or drill hole": {*half.points, *half.drill_holes},
        "fold": {fold.name for fold in half.folds},
        "region": {region.name for region in half.regions},
        "internal line": {*half.internal_lines},
    }
    stay = {"point or drill hole": set(own_points), "fold": set(own_folds)}
    for kind, names in kinds.items():
        for name in sorted(names - stay.get(kind, set())):
            if name + SUFFIX in names:
                raise SpecError(
                    f"the image of {kind} {name!r} would be called {name + SUFFIX!r} once the panel is unfolded, and one of that name is there; rename one",
                    key=key,
                )
