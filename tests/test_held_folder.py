"""One drape at a time writes into a folder."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from garmentcad.errors import FileError
from garmentcad.export.drape import finish
from garmentcad.io.held_folder import held_folder
from garmentcad.simulation.job import make_job

HOLD = """
import sys, time
from pathlib import Path
from garmentcad.io.held_folder import held_folder
with held_folder(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_another_process_is_refused_until_the_first_one_is_killed(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text("older")
    with subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True) as first:
        assert first.stdout is not None
        assert first.stdout.readline() == "held\n"
        try:
            job = make_job("straight-skirt", grid_mm=50.0, max_time_s=0.05)
            with pytest.raises(FileError, match=r"another drape.*folder") as refused:
                finish(job, lambda progress: None, tmp_path)
            assert (refused.value.file, refused.value.key) == (str(tmp_path), None)
        finally:
            first.kill()
    assert [path.name for path in tmp_path.iterdir()] == ["report.json"], "the refused drape touched nothing, and holding makes no file"
    with held_folder(tmp_path):
        pass


def test_a_folder_is_free_again_after_a_fault(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="fault"), held_folder(tmp_path):
        raise RuntimeError("fault")
    with held_folder(tmp_path), pytest.raises(FileError, match="another drape"), held_folder(tmp_path):
        pass
