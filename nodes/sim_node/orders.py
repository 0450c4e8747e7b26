"""Validates orders before anything is done: each is accepted, or rejected with a reason."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

import numpy as np

from nodes.sim_node.bodies import BodyRecord
from nodes.sim_node.models.library import Model, ModelError
from nodes.sim_node.models.parts import Vec3
from nodes.sim_node.physics import build
from schemas.entities import Pose
from schemas.scenes import BodyOrder, Placement

REACH_M = 1000.0
"""No body is put farther than this from the origin."""

ModelSource = Callable[[str, Vec3 | None], Model]
"""A model by its name, at a size [m] or at its own. Raises ModelError."""

Newcomer = tuple[BodyRecord, Model]


def newcomers(
    orders: Iterable[BodyOrder], models: ModelSource, taken: Callable[[str], bool]
) -> tuple[dict[str, Newcomer], dict[str, str]]:
    """What is to be made, by name, and why the rest cannot be; models read from files may take their time."""
    accepted: dict[str, Newcomer] = {}
    failed: dict[str, str] = {}
    for order in orders:
        try:
            if order.name in accepted:
                raise ModelError(f"a body named {order.name} is requested twice")
            if taken(order.name):
                raise ModelError(f"the scene already has a body named {order.name}")
            _check_reach(order.pose)
            accepted[order.name] = _newcomer(order, models(order.model, order.size_m))
        except ModelError as error:
            failed[order.name] = str(error)
    return accepted, failed


def _newcomer(order: BodyOrder, model: Model) -> Newcomer:
    x, y, z = model.inertial.centre_m
    record = BodyRecord(
        name=order.name,
        class_=order.class_,
        model=model.name,
        size_m=model.size_m,
        origin_m=(-x, -y, -z),
        ordered=order.pose,
        fixed=order.fixed,
        entity=order.commit > 0,
        masks=[build.mask_of(part) for part in model.parts],
        commit=order.commit,
        shape_commit=order.commit,
    )
    return record, model


def moves(placements: Iterable[Placement], there: Collection[str]) -> tuple[list[Placement], dict[str, str]]:
    """What is to be moved, and why the rest, by name, cannot be."""
    accepted: list[Placement] = []
    failed: dict[str, str] = {}
    for placement in placements:
        try:
            if placement.name not in there:
                raise ModelError(f"the scene has no body named {placement.name}")
            _check_reach(placement.pose)
            accepted.append(placement)
        except ModelError as error:
            failed[placement.name] = str(error)
    return accepted, failed


def _check_reach(pose: Pose) -> None:
    distance = float(np.linalg.norm(pose.position_m))
    if distance > REACH_M:
        raise ModelError(f"{distance:.0f} m from the origin is too far; the limit is {REACH_M:.0f} m")
