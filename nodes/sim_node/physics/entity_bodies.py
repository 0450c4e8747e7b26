"""Which bodies of a world file are entities, and which are parts of others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import mujoco

from semmap.nodes.sim_node.body_classes import BodyClasses, Found

_GROUND = 0


def find_entities(
    model: mujoco.MjModel, classes: BodyClasses, declared: Mapping[str, str]
) -> tuple[list[int], dict[int, Found]]:
    """Return the entity that each body is or is a part of, 0 for none, and the classes of the entities.

    Bodies are numbers in `model`. Entities are all named bodies on the top level, and nested ones whose class
    is declared, or certain and not that of a part. `declared` has classes by name. A body that only groups
    others, such as `chairs` without geoms around `chair_1` and `chair_2`, is not an entity.
    """
    names = [model.body(number).name for number in range(model.nbody)]
    of = [Found(None, is_sure=False)]
    for name in names[1:]:
        stated = declared.get(name)
        of.append(Found(stated, is_sure=True, is_stated=True) if stated else classes.find(name))
    frames = _find_frames(model, of)
    variants = _find_variants(model, classes, names, of)
    owner, found = [_GROUND] * model.nbody, dict[int, Found]()
    for number in range(1, model.nbody):  # parents have lower numbers than their parts
        parent = int(model.body_parentid[number])
        whole = owner[number] = owner[parent]
        moves = whole in frames and model.body_weldid[number] != model.body_weldid[whole]
        if names[number] and (
            parent == _GROUND
            or number in variants
            or classes.is_separate(names[number], of[number], names[whole], of[whole], moves=moves)
        ):
            owner[number], found[number] = number, of[number]
    _drop_groups(model, classes, owner, found)
    return owner, found


def _find_variants(
    model: mujoco.MjModel, classes: BodyClasses, names: Sequence[str], of: Sequence[Found]
) -> set[int]:
    """Return the bodies `cup_1`, `cup_2` or `cup_red`, `cup_blue` in a body `cup` without geoms and joints.

    They are parts beside another part of the cup, such as `cup_base`.
    """
    variants, others = defaultdict[int, list[int]](list), set[int]()
    for number in range(1, model.nbody):
        parent = int(model.body_parentid[number])
        has_own = model.body_geomnum[parent] or model.body_jntnum[parent]
        if parent == _GROUND or has_own:
            continue
        is_alike = of[number].class_ == of[parent].class_
        if is_alike and of[number].is_sure and classes.is_variant(names[number], names[parent]):
            variants[parent].append(number)
        elif model.body_geomnum[number] and (is_alike or not of[number].is_sure):
            others.add(parent)
    rows = [row for parent, row in variants.items() if len(row) > 1 and parent not in others]
    return {number for row in rows for number in row}


def _drop_groups(
    model: mujoco.MjModel, classes: BodyClasses, owner: list[int], found: dict[int, Found]
) -> None:
    """Remove the entities that only group others of their class, without geoms and joints of their own."""
    own, inner = defaultdict[int, list[int]](list), defaultdict[int, list[int]](list)
    for number, whole in enumerate(owner):
        own[whole].append(number)
        if number in found:
            inner[owner[model.body_parentid[number]]].append(number)
    for number in sorted(found, reverse=True):  # inner groups first
        parts = [found[part] for part in inner[number]]
        if len(parts) < 2 or not classes.is_group(found[number], parts):
            continue
        if any(model.body_geomnum[part] or model.body_jntnum[part] for part in own[number]):
            continue  # bodies that a joint moves together are one entity
        above = owner[model.body_parentid[number]]
        for part in own[number]:
            owner[part] = above
        inner[above] += inner[number]
        inner[above].remove(number)
        del found[number]


def _find_frames(model: mujoco.MjModel, of: Sequence[Found]) -> set[int]:
    """Return the bodies with geoms that do not move with a joint of a part.

    Geoms of nested bodies count unless these have a certain class. A group of furniture has no frame.
    """
    frames = set[int]()
    for number in range(1, model.nbody):
        whole = number
        while model.body_geomnum[number] and whole != _GROUND:
            if model.body_weldid[whole] == model.body_weldid[number]:
                frames.add(whole)
            if of[whole].is_sure:
                break
            whole = int(model.body_parentid[whole])
    return frames
