"""Reads model files in a separate process: a few lines of MJCF may describe millions of bodies.

The process is this module as a program. What the two pickle comes from them, never from a file.
"""

from __future__ import annotations

import pickle
import time
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

from semmap.nodes.runtime.isolated_process import IsolatedProcess, program, serve
from semmap.nodes.sim_node.models.library import Model, ModelError
from semmap.nodes.sim_node.models.model_files import read_model
from semmap.nodes.sim_node.models.parts import Vec3
from semmap.schemas import errors

_CPU_S: Final = 30.0
"""Time limit of a file [s of CPU time]."""
_ATTEMPTS: Final = 3
"""How often a file is read that ends the process or exceeds a limit, which may be due to a busy machine."""
_PAUSE_S: Final = 60.0
"""Time after the end of such an attempt until the next one [s]."""


@dataclass
class _Reading:
    """The result of a file: a model, the text of an error of the file, or of the last failed attempt."""

    found: Model | str = ""
    attempts_left: int = _ATTEMPTS
    next_s: float = 0.0
    """The earliest time of the next attempt on the monotonic clock [s]."""


class ModelReader(IsolatedProcess):
    """Reads one model at a time, like `read_model`. The process starts with the first."""

    remedy = "simplify the model"

    def __init__(self, cpu_s: float = _CPU_S) -> None:
        """Create it; reading a file may take `cpu_s` of CPU time."""
        super().__init__(program(__name__), cpu_s=cpu_s)
        self._readings = lru_cache(maxsize=256)(lambda *_: _Reading())

    def __call__(self, path: Path, size_m: Vec3 | None, version: int) -> Model:
        """Return the model in a file. Raises ModelError also for a file that exceeds a limit.

        The simulator asks for a model again and again, so errors are remembered until the file changes. A
        file that ended the process or exceeded a limit is read again after a pause, a few times.
        """
        reading = self._readings(path, size_m, version)
        if reading.attempts_left and time.monotonic() >= reading.next_s:
            self._read(reading, path, size_m, version)
        if isinstance(reading.found, str):
            raise ModelError(reading.found)
        return reading.found

    def _read(self, reading: _Reading, path: Path, size_m: Vec3 | None, version: int) -> None:
        try:
            content = self.exchange(pickle.dumps((path, size_m, version)), f"model file {path}")
        except (errors.BadFile, errors.Refused) as error:
            reading.found = error.text
            reading.attempts_left -= 1
            reading.next_s = time.monotonic() + _PAUSE_S
            return
        reading.found = pickle.loads(content)
        reading.attempts_left = 0


def answer(request: bytes) -> bytes:
    """Return the pickled model of a pickled path, size and version, or the text of the error."""
    path, size_m, version = pickle.loads(request)
    found: Model | str
    try:
        found = read_model(path, size_m, version)
    except ModelError as error:
        found = str(error)
    except OSError as error:
        found = f"cannot read model file {path}: {error.strerror}"
    return pickle.dumps(found)


if __name__ == "__main__":
    serve(answer)
