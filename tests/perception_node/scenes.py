"""A table with a few things, seen by two simulated depth cameras."""

import math
from functools import cache

import numpy as np

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.vision.view import look_at
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot, Stage

HEIGHT_M = 0.7
KINDS = {"cereals": (-0.2, -0.3), "apple": (0.1, -0.1), "bottle": (-0.1, 0.15), "basket": (0.05, 0.45)}


def item(name, kind, position, yaw=0.0, size=None):
    own = MODELS[kind]
    return Item(name, kind, size or own.size_m, own.colour, position, yaw)


@cache
def shot() -> Shot:
    return shot_of([item(kind, kind, (x, y, HEIGHT_M + 0.001), 0.4) for kind, (x, y) in KINDS.items()])


def shot_of(things) -> Shot:
    stage = Stage()
    bodies = stage.show([item("table", "table", (0.0, 0.0, 0.0), 0.0, (0.8, 1.4, HEIGHT_M)), *things])
    target = np.array([0.0, 0.0, HEIGHT_M])
    views = [
        look_at(
            target + np.array([1.2 * math.cos(a), 1.2 * math.sin(a), 0.9]), target, 640, 480, math.radians(50)
        )
        for a in (0.3, 1.9)
    ]
    return stage.shoot(bodies, views, np.random.default_rng(0))
