"""python -m garmentcad is garmentcad."""

from garmentcad.cli.main import run

run()
