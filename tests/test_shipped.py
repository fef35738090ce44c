"""Where files are found: shipped names, and references that must stay in their folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from garmentcad.errors import FileError, did_you_mean
from garmentcad.io import shipped
from garmentcad.io.shipped import resolve_reference, shipped_file, shipped_names


@pytest.fixture
def wheel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed package with its data inside."""
    package = tmp_path / "site" / "garmentcad"
    for kind, names in {"patterns": ["skirt.yaml", "shirt.yaml"], "fabrics": ["denim.yaml", "denim.csv"], "mannequins": ["human.npz", "woman-88.yaml"]}.items():
        folder = package / "data" / kind
        folder.mkdir(parents=True)
        for name in names:
            (folder / name).write_text("x")
    monkeypatch.setattr(shipped, "_PACKAGE", package)
    return package


def test_installed_data(wheel: Path) -> None:
    assert shipped_names("patterns") == ["shirt", "skirt"]
    assert shipped_names("mannequins") == ["woman-88"]
    assert shipped_file("patterns", "skirt") == wheel / "data" / "patterns" / "skirt.yaml"
    assert shipped_file("mannequins", "human.npz").is_file()


def test_repository_data() -> None:
    root = Path(shipped.__file__).resolve().parents[2]
    assert "flared-skirt" in shipped_names("patterns")
    assert shipped_file("patterns", "flared-skirt") == root / "patterns" / "flared-skirt.yaml"


@pytest.mark.parametrize(
    "name",
    ["skrit", "", "../patterns/skirt", "skirt.yaml.yaml", "/etc/passwd", "a\0b", "x" * 100_000, "..", ".", "skirt."],
    ids=lambda name: repr(name[:9]),
)
def test_unknown_names(wheel: Path, name: str) -> None:
    with pytest.raises(FileError) as caught:
        shipped_file("patterns", name)
    assert "shirt, skirt" in str(caught.value)
    assert len(str(caught.value)) < 400


def test_did_you_mean(wheel: Path) -> None:
    with pytest.raises(FileError, match="did you mean 'skirt'"):
        shipped_file("patterns", "skrit")


def test_small_and_capital_letters_mean_the_same_name() -> None:
    assert did_you_mean("2hg", ["2HB", "2HG", "2HG5"]).startswith("; did you mean '2HG'?")
    assert did_you_mean("MIU", ["mmd", "miu"]).startswith("; did you mean 'miu'?")


def test_of_sizes_the_next_one_is_meant() -> None:
    sizes = [f"woman-{size}" for size in range(76, 124, 4)]
    assert did_you_mean("yes", ["top", "hem", "top"]) == ". Allowed: hem, top"
    assert did_you_mean("woman-89", [*sizes, "man-88"]).startswith("; did you mean 'woman-88'?")
    assert did_you_mean("woman-999", sizes).startswith("; did you mean 'woman-120'?")
    assert did_you_mean("panel3", ["panels", "pane"]).startswith("; did you mean 'panels'?")


def test_references(wheel: Path, tmp_path: Path) -> None:
    folder = tmp_path / "specs"
    (folder / "cloth").mkdir(parents=True)
    (folder / "mine.yaml").write_text("x")
    (folder / "cloth" / "wool.csv").write_text("x")
    (folder / "inside").symlink_to(folder / "cloth")
    assert resolve_reference("denim", "fabrics", folder) == wheel / "data" / "fabrics" / "denim.yaml"
    assert resolve_reference("mine.yaml", "fabrics", folder) == folder / "mine.yaml"
    assert resolve_reference("./cloth/wool.csv", "fabrics", folder) == folder / "cloth" / "wool.csv"
    assert resolve_reference("inside/wool.csv", "fabrics", folder) == folder / "cloth" / "wool.csv"


def test_references_that_lead_out(wheel: Path, tmp_path: Path) -> None:
    folder = tmp_path / "specs"
    folder.mkdir()
    secret = tmp_path / "secret.yaml"
    secret.write_text("x")
    (folder / "link.yaml").symlink_to(secret)
    (folder / "up").symlink_to(tmp_path)
    (folder / "loop.yaml").symlink_to(folder / "loop.yaml")
    for text, message in (
        ("../secret.yaml", "is refused"), ("a/../../secret.yaml", "is refused"), (str(secret), "is refused"), ("..\\secret.yaml", "is refused"),
        ("link.yaml", "leads out"), ("up/secret.yaml", "leads out"), ("loop.yaml", "does not exist"), ("none.yaml", "does not exist"),
        ("./", "not a file"), ("", "is refused"), ("a\0.yaml", "is refused"), ("x" * 5000 + ".yaml", "does not exist"), ("danim", "did you mean 'denim'"),
    ):  # fmt: skip
        with pytest.raises(FileError) as caught:
            resolve_reference(text, "fabrics", folder)
        assert message in str(caught.value), text
