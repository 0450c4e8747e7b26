"""Model sources: the user's files, or the library."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from semmap.nodes.sim_node.models.library import Model, ModelError
from semmap.nodes.sim_node.models.library import build as built_in
from semmap.nodes.sim_node.models.model_files import MESHES, SUFFIXES, read_model
from semmap.nodes.sim_node.models.parts import Vec3
from semmap.nodes.sim_node.models.readable import require_readable, require_references
from semmap.schemas.errors import did_you_mean

ReadModel = Callable[[Path, Vec3 | None, int], Model]
"""Returns the model in a file at a size [m] or its own; the last argument identifies the file's content."""


@dataclass(frozen=True)
class Models:
    """Models of files in `folder` or at a path, with precedence over the library's.

    `chair.glb` in the folder replaces the model `chair`. A model may itself be a path (`/home/me/sofa.obj`)
    within the folder or `data`; other files must not be read because of a name in the map. Called with a name
    and a size, it returns the model, or raises ModelError for an invalid file.
    """

    folder: Path | None = None
    data: Path | None = None
    """The data folder of the system."""
    read: ReadModel = read_model
    """Reads a model file in this process; `ModelReader` does in another."""

    def __call__(self, name: str, size_m: Vec3 | None) -> Model:
        """Return the model `name` at `size_m`, or at its own size."""
        path = self._path(name)
        if path is None:
            return built_in(name, size_m)
        roots = [root for root in (self.folder, self.data) if root is not None]
        require_readable(path, roots)
        try:
            if path.suffix not in MESHES:
                require_references(path, roots)
            return self.read(path, size_m, path.stat().st_mtime_ns)
        except OSError as error:
            raise ModelError(f"cannot read model file {path}: {error.strerror}") from None

    def _path(self, name: str) -> Path | None:
        if name.endswith(SUFFIXES):
            if self.folder is None and not Path(name).is_absolute():
                raise ModelError(
                    f"model file {name} is searched in the folder given by `semmap up --models DIR`,"
                    " but none was given"
                )
            return (self.folder or Path()) / name
        candidates = [self.folder / f"{name}{suffix}" for suffix in SUFFIXES] if self.folder and name else []
        return next((path for path in candidates if path.is_file()), None)


def ignored_files(folder: Path, models: Collection[str]) -> list[str]:
    """Return the model files of `folder` that match none of `models`, with suggestions."""
    return [
        path.name + (f" ({hint.removeprefix('; ')})" if (hint := did_you_mean(path.stem, models)) else "")
        for path in sorted(folder.iterdir())
        if path.suffix.lower() in SUFFIXES and not is_one_of(path, models)
    ]


def is_one_of(path: Path, models: Collection[str]) -> bool:
    """Return whether a file is that of one of these models."""
    return path.suffix in SUFFIXES and any(name in models for name in (path.stem, path.name, str(path)))
