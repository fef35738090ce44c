"""Who looks at a run between two stretches of steps, where its State is whole: passes progress on, keeps the checkpoint fresh, stops where the user asked."""

from __future__ import annotations

import math
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from garmentcad.cloth.state import State
from garmentcad.errors import FileError
from garmentcad.simulation.checkpoint import save_state
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job

CHECKPOINT_EVERY_S = 5.0


class Interrupted(KeyboardInterrupt):
    """The user stopped the run; the checkpoint named in the message continues it. No GarmentError: who goes on with the next garment where one fails must not
    go on where Ctrl-C was pressed."""


class Keeper:
    """Of one job. path: of the checkpoint, None for none; stopped: not empty once the user has asked to stop; begin, reserve: as of `run`."""

    def __init__(
        self, job: Job, path: Path | None, look: Callable[[Progress], None], stopped: list[int], begin: Callable[[], None], reserve: Callable[[], None]
    ) -> None:
        self.job, self.path, self.begin = job, path, begin
        self._look, self._stopped, self._reserve = look, stopped, reserve
        self._saved = -math.inf  # the first look saves: whatever stops the run later, it can be resumed
        self.state: State | None = None

    def below(self, job: Job) -> Keeper:
        """That of what is worn below, whose run is a part of this one: until it has ended its checkpoint is the one of both."""
        return Keeper(job, self.path, self._look, self._stopped, self._reserve, self._reserve)

    def __call__(self, progress: Progress) -> None:
        self._look(progress)
        due = time.perf_counter() - self._saved > CHECKPOINT_EVERY_S
        if self.path is not None and self.state is not None and (due or self._stopped):
            self._save(self.path, self.state)
        if self._stopped:
            raise Interrupted(f"stopped at step {progress.step}" + (f"; --resume goes on from {self.path}" if self.path is not None else ""))

    def _save(self, path: Path, state: State) -> None:
        """Where a disk is full later on a UserWarning says so, and the run goes on: the next checkpoint is tried. FileError where it is so from the beginning,
        and where the run is stopped, which would leave nothing to go on from."""
        try:
            save_state(path, state, self.job.identity)
        except FileError as error:
            if self._stopped or self._saved == -math.inf:
                raise
            warnings.warn(f"{error}; the run goes on, and a break would cost what was done since the last checkpoint", stacklevel=2)
        self._saved = time.perf_counter()


@contextmanager
def stop_signal() -> Iterator[list[int]]:
    """Ctrl-C sets a flag instead of tearing a step apart; a second one stops at once. Outside the main thread signals are left alone, and in a program that
    handles them without Python: what it has set could not be put back."""
    stopped: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if stopped:
            raise KeyboardInterrupt
        stopped.append(number)

    before = signal.getsignal(signal.SIGINT)
    if before is None or threading.current_thread() is not threading.main_thread():
        yield stopped
        return
    signal.signal(signal.SIGINT, note)
    try:
        yield stopped
    finally:
        signal.signal(signal.SIGINT, before)
