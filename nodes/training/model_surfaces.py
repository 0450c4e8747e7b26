"""Surface points of every model, for perception, which has no access to the library: `make shapes`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.fitting.model_surfaces import SHIPPED, ModelSurface, save
from semmap.nodes.sim_node.models.facets import facets
from semmap.nodes.sim_node.models.library import Model, build
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Floats, Part, Role, Shape, rotation_matrix
from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.nodes.training.taxonomy import class_of_models
from semmap.ontology.model_shapes import varieties_of

POINTS = 450
_TRIES = 8
"""The oversampling factor; sampled points inside another part are invisible and discarded."""
_WITHIN = 0.004
"""Points deeper inside another part than this share of the largest extent count as inside."""
_ALIKE, _MOST = 0.03, 0.96
"""A rotation is a symmetry if it moves almost no point off the surface by this share of the larger side."""
_TURNS_RAD = np.radians([20.0, 47.0, 90.0, 131.0, 180.0])


def library_surfaces() -> dict[str, list[ModelSurface]]:
    """Return the surfaces of the models of each class: first its default model, then the varieties."""
    surfaces = {model: surface_of(build(model, None)) for model in sorted(KINDS)}
    return {class_: [surfaces[model] for model in models] for class_, models in library_models().items()}


def library_models() -> dict[str, list[str]]:
    """Return the models of each class, in the order of `library_surfaces`."""
    standing: dict[str, list[str]] = {}
    for model, class_ in sorted(class_of_models(MODELS).items()):
        standing.setdefault(class_, []).append(model)
    varieties = {c: [v for model in models for v in varieties_of(model)] for c, models in standing.items()}
    return {c: list(dict.fromkeys([*models, *varieties[c]])) for c, models in standing.items()}


def surface_of(model: Model) -> ModelSurface:
    """Return points that are evenly distributed over the visible surface, and their outward normals."""
    rng = np.random.default_rng(1)
    parts = [part for part in model.parts if part.role is not Role.COLLISION]
    points, normals, owners = _drawn(parts, _TRIES * POINTS, rng)
    seen = np.ones(len(points), bool)
    for number, part in enumerate(parts):
        seen &= (owners == number) | (outside_m(points, part) > -_WITHIN * max(model.size_m))
    points, normals = points[seen], normals[seen]
    kept, size_m = _spread(points, POINTS), np.array(model.size_m)
    return ModelSurface(points[kept], normals[kept], size_m, _fold(points, parts, size_m))


def _drawn(
    parts: Sequence[Part], count: int, rng: np.random.Generator
) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Sample points, normals and part numbers, in proportion to the area of each part."""
    corners, normals, owners = [], [], []
    for number, part in enumerate(parts):
        found = facets(part)
        corners.append(found.points[found.triangles])
        normals.append(found.normals[found.triangles])
        owners.append(np.full(len(found.triangles), number))
    triangles, across, owner = np.concatenate(corners), np.concatenate(normals), np.concatenate(owners)
    areas = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    chosen = np.searchsorted(np.cumsum(areas) / areas.sum(), (np.arange(count) + 0.5) / count)
    a, b = rng.random((2, count, 1))
    flip = a + b > 1.0
    a, b = np.where(flip, 1.0 - a, a), np.where(flip, 1.0 - b, b)
    weights = np.concatenate([1.0 - a - b, a, b], axis=1)[:, None]
    points = (weights @ triangles[chosen])[:, 0]
    normal = (weights @ across[chosen])[:, 0]
    return points, normal / np.linalg.norm(normal, axis=1, keepdims=True), owner[chosen]


def outside_m(points: Floats, part: Part) -> Floats:
    """Return (N,) distances of points from the surface of a part, negative inside it; large for a mesh."""
    own = (points - np.asarray(part.centre)) @ rotation_matrix(part.turn)
    half = np.asarray(part.half)
    match part.shape:
        case Shape.BOX:
            beyond = np.abs(own) - half
        case Shape.CYLINDER:
            beyond = np.stack([np.hypot(own[:, 0], own[:, 1]) - half[0], np.abs(own[:, 2]) - half[2]], axis=1)
        case Shape.CAPSULE:
            above = np.maximum(np.abs(own[:, 2]) - half[2], 0.0)
            return np.asarray(np.sqrt(own[:, 0] ** 2 + own[:, 1] ** 2 + above**2) - half[0])
        case Shape.ELLIPSOID:
            reach = np.linalg.norm(own / half, axis=1)
            return np.asarray((reach - 1.0) * np.linalg.norm(own, axis=1) / np.maximum(reach, 1e-9))
        case Shape.MESH:
            return np.full(len(points), np.inf)
    return np.asarray(np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0))


def _fold(points: Floats, parts: Sequence[Part], size_m: Floats) -> int:
    """Return the order of a model's rotational symmetry about z (see `ModelSurface`), by point distances."""
    within = _ALIKE * float(max(size_m[:2]))

    def same(turn_rad: float) -> bool:
        c, s = np.cos(turn_rad), np.sin(turn_rad)
        turned = points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        away = np.abs(np.min([outside_m(turned, part) for part in parts], axis=0))
        return float(np.mean(away < within)) > _MOST

    if all(same(turn) for turn in _TURNS_RAD):
        return 0
    return next((fold for fold in (4, 2) if same(2.0 * np.pi / fold)), 1)


def _spread(points: Floats, count: int) -> NDArray[np.intp]:
    """Return the rows of `count` distant points: each is the farthest from the previous ones."""
    chosen = np.zeros(min(count, len(points)), np.intp)
    away = np.full(len(points), np.inf)
    for n in range(1, len(chosen)):
        away = np.minimum(away, ((points - points[chosen[n - 1]]) ** 2).sum(axis=1))
        chosen[n] = np.argmax(away)
    return chosen


if __name__ == "__main__":
    save(library_surfaces(), SHIPPED)
