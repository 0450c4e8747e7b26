"""Which bodies of a world file are entities, and which are parts of others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco

from semmap.nodes.sim_node.body_classes import BodyClasses, Found

_GROUND = 0


def find_entities(
    model: mujoco.MjModel, classes: BodyClasses, declared: Mapping[str, str]
) -> tuple[list[int], dict[int, Found]]:
    """Return the entity that each body is or is a part of, 0 for none, and the classes of the entities.

    Bodies are numbers in `model`. Entities are all named bodies on the top level, and nested ones whose class
    is declared, or certain and not that of a part. `declared` has classes by name.
    """
    names = [model.body(number).name for number in range(model.nbody)]
    of = [Found(None, is_sure=False)]
    for name in names[1:]:
        stated = declared.get(name)
        of.append(Found(stated, is_sure=True, is_stated=True) if stated else classes.find(name))
    frames = _find_frames(model, of)
    owner, found = [_GROUND] * model.nbody, dict[int, Found]()
    for number in range(1, model.nbody):  # parents have lower numbers than their parts
        parent = int(model.body_parentid[number])
        whole = owner[number] = owner[parent]
        moves = whole in frames and model.body_weldid[number] != model.body_weldid[whole]
        if names[number] and (
            parent == _GROUND
            or classes.is_separate(names[number], of[number], names[whole], of[whole], moves=moves)
        ):
            owner[number], found[number] = number, of[number]
    return owner, found


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
