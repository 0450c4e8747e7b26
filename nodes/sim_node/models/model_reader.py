"""Reads model files in a separate process: a few lines of MJCF may describe millions of bodies.

The process is this module as a program. What the two pickle comes from them, never from a file.
"""

from __future__ import annotations

import pickle
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


class ModelReader(IsolatedProcess):
    """Reads one model at a time, like `read_model`. The process starts with the first."""

    remedy = "simplify the model"

    def __init__(self, cpu_s: float = _CPU_S) -> None:
        """Create it; reading a file may take `cpu_s` of CPU time."""
        super().__init__(program(__name__), cpu_s=cpu_s)
        self._read = lru_cache(maxsize=256)(self._read_once)

    def __call__(self, path: Path, size_m: Vec3 | None, version: int) -> Model:
        """Return the model in a file. Raises ModelError also for a file that exceeds a limit.

        Errors are remembered, too, because the simulator asks for a model again and again.
        """
        found = self._read(path, size_m, version)
        if isinstance(found, str):
            raise ModelError(found)
        return found

    def _read_once(self, path: Path, size_m: Vec3 | None, version: int) -> Model | str:
        try:
            content = self.exchange(pickle.dumps((path, size_m, version)), f"model file {path}")
        except errors.BadFile as error:
            return error.text
        found: Model | str = pickle.loads(content)
        return found


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
