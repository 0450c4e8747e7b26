"""The surfaces of the models of classes as points, and their file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.errors import BadFile

SHIPPED = Path(__file__).with_name("model_surfaces.npz")

_FINE = 2000.0
"""Points are stored in this many steps per side of the box: half a millimetre in a metre."""
_STEEP = 31.0
_SQUARE = 1.12
"""A model that is longer than wide by more has at most two-fold symmetry."""


@dataclass(frozen=True)
class ModelSurface:
    """A model of a class: `points` (N, 3) [m] and outward unit `normals` (N, 3) in its own frame.

    The origin is the bottom centre, x to the front, z up. `size_m` (3,): size along its axes. `fold`:
    rotational symmetry about z: 0 for round, 1 for none.
    """

    points: Numbers
    normals: Numbers
    size_m: Numbers
    fold: int = 1

    def scaled(self, size_m: Numbers) -> ModelSurface:
        """Return the model stretched to a size."""
        factor = size_m / self.size_m
        normals = self.normals / factor
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        square = max(size_m[:2]) <= _SQUARE * min(size_m[:2])
        return ModelSurface(
            self.points * factor, normals, size_m, self.fold if square or self.fold == 1 else 2
        )

    def rotated(self, rotation: Numbers) -> ModelSurface:
        """Return the model rotated by (3, 3), with its bottom centre at the origin."""
        points = self.points @ rotation.T
        low, high = points.min(axis=0), points.max(axis=0)
        middle = (low + high) / 2.0
        return ModelSurface(
            points - [middle[0], middle[1], low[2]], self.normals @ rotation.T, np.asarray(high - low)
        )


ClassSurfaces = Mapping[str, Sequence[ModelSurface]]
"""The models of each class, the usual one first."""


def save(surfaces: ClassSurfaces, path: Path) -> None:
    """Write the models as a compressed NumPy archive, with quantised points and normals."""
    rows = [(class_, model) for class_, models in surfaces.items() for model in models]
    points = [np.round(model.points / model.size_m * _FINE).astype(np.int16) for _, model in rows]
    normals = [np.round(model.normals * _STEEP).astype(np.int8) for _, model in rows]
    np.savez_compressed(
        path,
        classes=np.array([class_ for class_, _ in rows]),
        counts=np.array([len(own) for own in points]),
        sizes_m=np.array([model.size_m for _, model in rows]),
        folds=np.array([model.fold for _, model in rows]),
        points=np.concatenate(points).T,
        normals=np.concatenate(normals).T,
    )


def load(path: Path = SHIPPED) -> dict[str, list[ModelSurface]]:
    """Read models that `save` wrote. Raises BadFile if they are invalid."""
    found: dict[str, list[ModelSurface]] = {}
    try:
        with np.load(path, allow_pickle=False) as arrays:
            ends = np.cumsum(arrays["counts"])[:-1]
            points = np.split(arrays["points"].T.astype(float) / _FINE, ends)
            normals = np.split(arrays["normals"].T.astype(float), ends)
            rows = zip(arrays["classes"].tolist(), points, normals, arrays["sizes_m"], strict=True)
            for (class_, own, across, size_m), fold in zip(rows, arrays["folds"].tolist(), strict=True):
                across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-9)
                found.setdefault(class_, []).append(ModelSurface(own * size_m, across, size_m, fold))
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} has no valid surfaces of models: {error}") from None
    return found


@lru_cache(maxsize=1)
def shipped() -> dict[str, list[ModelSurface]]:
    """Return the models that ship with semmap."""
    return load()
