"""garmentcad: the command line. Commands live in their own files and load the program only when they run, so that --help is quick."""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any

import typer
from typer.core import TyperGroup

from garmentcad import __version__
from garmentcad.cli import bench, check, compare, drape, fabric, fit, importing, mannequin, output, test
from garmentcad.cli.named import by_option
from garmentcad.errors import GarmentError, InputError

EXIT_REFUSED, EXIT_NOT_AT_REST, EXIT_INTERRUPTED = 2, 3, 130

ABOUT = "Garments from sewn patterns and measured fabrics, draped on mannequins."


class Commands(TyperGroup):
    """The commands. One that is stopped says how far it came; typer by itself ends a KeyboardInterrupt without a word."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        refuse_empty(args)
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stopped:
            if str(stopped):
                print(f"garmentcad: {stopped}", file=sys.stderr)
            raise typer.Exit(EXIT_INTERRUPTED) from None


def refuse_empty(args: Sequence[str]) -> None:
    """InputError for an empty word. None means anything, and as a path it would be the working folder, from which a drape takes away older results."""
    for before, word in zip(("", *args), args):
        option, value = word.split("=", 1) if word.startswith("--") and "=" in word else (before, word)
        if not value:
            key = option if option.startswith("-") else None
            raise InputError("an empty text came; a name, a file or a folder is wanted (a shell variable that is not set is empty)", key=key)


app = typer.Typer(cls=Commands, no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, help=ABOUT)
app.command()(drape.drape)
app.command()(check.check)
app.command("test")(test.garment_test)
app.command()(bench.bench)
app.command("import")(importing.import_file)
app.command()(output.render)
app.command()(output.export)
app.command()(fit.fit)
app.command()(compare.compare)
app.add_typer(fabric.app, name="fabric")
app.add_typer(mannequin.app, name="mannequin")


@app.callback(invoke_without_command=True)
def _root(show_version: bool = typer.Option(False, "--version", help="Print the version and exit.")) -> None:
    if show_version:
        print(__version__)
        raise typer.Exit


_with_place = warnings.formatwarning


def _as_said(message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None) -> str:
    """What the program warns of, without the line of it that does."""
    return f"garmentcad: warning: {message}\n" if category is UserWarning else _with_place(message, category, filename, lineno, line)


def run() -> None:
    """Entry point. Exit codes: 0 done, 1 fault of the program, 2 input refused, 3 not at rest or intersecting, 4 assertion failed, 130 interrupted."""
    _mend_streams()
    warnings.formatwarning = _as_said
    try:
        app()
    except InputError as error:
        print(f"garmentcad: {by_option(error)}", file=sys.stderr)
        sys.exit(EXIT_REFUSED)
    except GarmentError as error:
        print(f"garmentcad: {error}", file=sys.stderr)
        sys.exit(EXIT_NOT_AT_REST)
    except OSError as error:
        if error.filename is None:
            raise
        print(f"garmentcad: {error.filename}: {error.strerror}", file=sys.stderr)
        sys.exit(EXIT_REFUSED)
    except KeyboardInterrupt:
        sys.exit(EXIT_INTERRUPTED)


def _mend_streams() -> None:
    """Output that is closed takes what it is given, and one that cannot show a character shows its number: what is done must not fail by what is printed of
    it."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
