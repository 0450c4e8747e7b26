"""The data on the library's models that ship with the knowledge base and perception."""

from __future__ import annotations

from functools import cache

import numpy as np

from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface, shipped
from semmap.nodes.sim_node.models.convex_parts import convex_part
from semmap.nodes.sim_node.models.library import Model, build
from semmap.nodes.sim_node.models.parts import Role
from semmap.nodes.training.model_surfaces import library_models, outside_m
from semmap.ontology.model_shapes import ConvexPart, ModelShape, shapes

_WITHIN_M = 0.001
"""The knowledge base's file is rounded to a tenth of a millimetre."""
_FLAT = 0.018
"""By so much of the model's longest side may flat faces be off what is round."""


@cache
def surfaces() -> dict[str, ModelSurface]:
    """Return the surface points of each model in perception."""
    return {
        model: surface
        for class_, models in library_models().items()
        for model, surface in zip(models, shipped()[class_], strict=True)
    }


def differences(name: str) -> list[str]:
    """Return how a model differs from these data; empty while both files are current."""
    model = build(name, None)
    return [*_in_shape(model, shapes()[name]), *_in_surface(model, surfaces().get(name))]


def _in_shape(model: Model, known: ModelShape) -> list[str]:
    """Compare with the knowledge base: size, collision geometry, and motion of doors and drawers."""
    solid = [part for part in model.parts if part.role is not Role.VISUAL]
    found = []
    if not np.allclose(model.size_m, known.size_m, atol=_WITHIN_M):
        found.append(f"{model.name} measures {model.size_m}, not {known.size_m}")
    if len(solid) != len(known.parts):
        return [*found, f"{model.name} has {len(solid)} parts that collide, not {len(known.parts)}"]
    for number, (part, there) in enumerate(zip(solid, known.parts, strict=True)):
        if not _is_one(convex_part(part), there):
            found.append(f"part {number} of {model.name} is elsewhere, or of another form")
    for leaf, shape in zip(model.leaves, known.leaves, strict=True):
        joint = leaf.joint
        own = (joint.name, joint.kind, joint.closed)
        rounded = shape.closed if shape.closed is None else joint.closed
        if own != (shape.name, shape.kind, rounded):
            found.append(f"joint {joint.name} of {model.name} is not {shape.name}")
        pairs = [(joint.anchor, shape.anchor), (joint.axis, shape.axis)]
        pairs += [(joint.range or (), shape.limits or ()), (((joint.closed or 0.0),), (shape.closed or 0.0,))]
        if not all(len(a) == len(b) and np.allclose(a, b, atol=_WITHIN_M) for a, b in pairs):
            found.append(f"joint {joint.name} of {model.name} moves in another way")
        moved = tuple(k for k, part in enumerate(solid) if part.joint == joint)
        if moved != shape.parts:
            found.append(f"joint {joint.name} of {model.name} moves {moved}, not {shape.parts}")
    return found


def _is_one(part: ConvexPart, known: ConvexPart) -> bool:
    pairs = zip(
        [(part.centre,), part.straight, part.round, part.points],
        [(known.centre,), known.straight, known.round, known.points],
        strict=True,
    )
    return all(
        np.shape(own) == np.shape(other) and np.allclose(own, other, atol=_WITHIN_M) for own, other in pairs
    )


def _in_surface(model: Model, known: ModelSurface | None) -> list[str]:
    """Compare with perception: its points lie on the visible surface of the model, and not inside.

    They were sampled from flat faces, sixteen for a round side, so they may lie slightly inside it.
    """
    if known is None:
        return []
    visible = [part for part in model.parts if part.role is not Role.COLLISION]
    away = np.min([outside_m(known.points, part) for part in visible], axis=0)
    slack_m = _FLAT * max(model.size_m)
    off = int(np.count_nonzero(np.abs(away) > slack_m))
    return [f"{off} points of {model.name} are not on its surface"] if off else []
