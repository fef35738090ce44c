"""Garment tests as files: `NAME.garment-test.yaml`, or the part `tests` of a garment spec. A folder stands for all test files in it and below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from garmentcad.errors import FileError, InputError, SpecError
from garmentcad.io.shipped import Kind, resolve_reference, shipped_names
from garmentcad.io.yaml_file import read_yaml
from garmentcad.pattern.garment_test import GarmentTest, GarmentTestFile
from garmentcad.pattern.parse import parse_model, parse_spec, shown

ENDING = ".garment-test.yaml"


@dataclass(frozen=True)
class GarmentTestCase:
    """One test and where it comes from. name: of the file without its ending, or SPEC.TEST for a test inside a spec; file: what was read; spec: the garment."""

    name: str
    file: Path
    spec: Path
    test: GarmentTest

    def resolve(self, reference: str | None, kind: Kind) -> str | None:
        """File of a fabric or mannequin that the test names. FileError as `resolve_reference`."""
        return None if reference is None else str(_resolved(reference, kind, self.file))

    @property
    def baseline_file(self) -> Path:
        """Where its baseline is kept."""
        return self.file.with_name(f"{self.name}.baseline.json")


def find_garment_tests(path: Path) -> list[Path]:
    """The files that a file or folder stands for. FileError for a folder without any."""
    if not path.is_dir():
        return [path]
    found = sorted(path.rglob(f"*{ENDING}"))
    if not found:
        raise FileError(f"there is no *{ENDING} in this folder or below", file=str(path))
    return found


def read_garment_tests(path: Path) -> list[GarmentTestCase]:
    """All tests in a file. FileError or SpecError (file, key path, what came, what is allowed) for what is not a garment test."""
    file = str(path)
    data = read_yaml(path)
    if not isinstance(data, dict):
        raise SpecError(f"a garment test is a mapping, came {shown(data)}", file=file)
    if "garments" in data:
        raise SpecError(f"is an outfit, which holds no tests; a test of it is a file of its own, NAME{ENDING}, that names it as its spec", file=file)
    if "panels" in data:
        spec = parse_spec(data, file)
        if not spec.tests:
            raise SpecError("this garment has no tests", file=file, key="tests")
        return [GarmentTestCase(f"{path.stem}.{name}", path, path, test) for name, test in spec.tests.items()]
    if "schema" not in data:
        raise SpecError("this key is missing; the first line of a garment test is `schema: 1`", file=file, key="schema")
    test = parse_model(GarmentTestFile, data, file)
    name = path.name.removesuffix(ENDING).removesuffix(path.suffix)
    if not name.strip("."):
        raise SpecError(f"a garment test has the name of its file before {ENDING}; {name!r} is no name", file=file)
    return [GarmentTestCase(name, path, _resolved(test.spec, "outfits" if test.spec in shipped_names("outfits") else "patterns", path), test)]


def distinct_names(cases: Sequence[GarmentTestCase]) -> list[str]:
    """A name for each test that no other one has: its own or, where several are called so, with as much of its folder before it as tells them apart (a/x, b/x).

    SpecError for two files of one folder whose tests have one name: they would share a baseline, too.
    """
    files: dict[tuple[str, ...], Path] = {}
    places = []
    for case in cases:
        file = case.file.resolve()
        place = (*file.parent.parts[1:], case.name)
        if files.setdefault(place, file) != file:
            raise SpecError(f"a test of {files[place].name} in the same folder is called {case.name!r}, too; rename one of the files", file=str(case.file))
        places.append(place)

    def shortest(place: tuple[str, ...]) -> str:
        count = 1
        while sum(other[-count:] == place[-count:] for other in files) > 1:
            count += 1
        return "/".join(place[-count:])

    return [shortest(place) for place in places]


def _resolved(reference: str, kind: Kind, file: Path) -> Path:
    try:
        return resolve_reference(reference, kind, file.parent)
    except InputError as error:
        raise FileError(error.message, file=str(file), key={"patterns": "spec", "outfits": "spec"}.get(kind, kind[:-1])) from None
