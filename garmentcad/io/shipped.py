"""Where data files are found: those that come with the program, and those that a spec refers to."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

from garmentcad.errors import FileError, did_you_mean

Kind = Literal["patterns", "fabrics", "mannequins", "poses", "outfits"]

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
_PACKAGE = Path(__file__).resolve().parents[1]


def shipped_folder(kind: Kind) -> Path:
    """Folder of the shipped files: garmentcad/data/KIND in an installed wheel, KIND at the repository root in an editable install."""
    installed = _PACKAGE / "data" / kind
    return installed if installed.is_dir() else _PACKAGE.parent / kind


def shipped_names(kind: Kind) -> list[str]:
    """Names of the shipped YAML files of a kind, sorted."""
    return sorted(path.stem for path in shipped_folder(kind).glob("*.yaml"))


def shipped_file(kind: Kind, name: str) -> Path:
    """Path of a shipped file: NAME.yaml, or the file itself where `name` carries its ending (`human.npz`). FileError for an unknown name."""
    folder = shipped_folder(kind)
    stem, dot, ending = name.partition(".")
    path = folder / (name if dot else f"{name}.yaml")
    if not _NAME.fullmatch(stem) or (dot and not _NAME.fullmatch(ending)) or not path.is_file():
        raise FileError(f"no shipped file of the kind {kind} is called {name[:100]!r}{did_you_mean(name, shipped_names(kind))}")
    return path


def resolve_reference(text: str, kind: Kind, base_folder: str | Path) -> Path:
    """File that a spec means by `text`: a shipped name (a word without dot and slash), or a file in the spec's folder or below it.

    base_folder: the folder of the file that refers. FileError for an unknown name, an absolute path, a path or link that leads out of the
    folder, or a file that does not exist.
    """
    if _NAME.fullmatch(text):
        return shipped_file(kind, text)
    shown = repr(text[:200])
    allowed = "allowed are a shipped name or a file in the folder of the spec or below it"
    relative = Path(text)
    if not text or "\0" in text or "\\" in text or relative.is_absolute() or ".." in relative.parts:
        raise FileError(f"the reference {shown} is refused; {allowed}")
    base = Path(base_folder).resolve()
    try:
        target = (base / relative).resolve(strict=True)
    except (OSError, RuntimeError):  # RuntimeError: a loop of links
        raise FileError(f"the reference {shown} names a file that does not exist in {base_folder}; {allowed}") from None
    if not target.is_relative_to(base):
        raise FileError(f"the reference {shown} leads out of {base_folder}; {allowed}")
    if not target.is_file():
        raise FileError(f"the reference {shown} is not a file; {allowed}")
    return target
