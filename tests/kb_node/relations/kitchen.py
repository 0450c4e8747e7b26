"""A kitchen with objects on, in, under, beside and against each other, for tests of all relations."""

import math

from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

LYING = (math.cos(math.pi / 4), 0.0, math.sin(math.pi / 4), 0.0)
"""Turned by 90 degrees about y."""
TILTED = (math.cos(math.radians(10)), 0.0, math.sin(math.radians(10)), 0.0)
"""Turned by 20 degrees about y."""
QUARTER = (0.7071068, 0.0, 0.0, -0.7071068)


def box(name, at, size, **described):
    """Return a box without a model."""
    return thing(name, at, "box", size=size, **described)


THINGS = (
    ROOM, CORNER, TABLE,
    # on the table
    thing("tray1", (0.0, 0.0, TOP)), thing("cup1", (0.05, 0.0, TOP + 0.01)),
    thing("bowl1", (0.0, -0.4, TOP)), thing("apple1", (0.0, -0.4, TOP + 0.02)),
    thing("book1", (0.0, 0.45, TOP)), box("book2", (0.02, 0.45, TOP + 0.03), (0.1, 0.14, 0.03)),
    box("plank1", (0.25, 0.0, TOP), (0.6, 0.2, 0.02)),
    thing("bottle1", (-0.3, -0.55, TOP + 0.04), turn=LYING),
    box("block1", (0.3, 0.5, TOP), (0.1, 0.1, 0.1), yaw=0.5),
    box("block2", (0.3, 0.5, TOP + 0.1), (0.1, 0.1, 0.1)),
    box("block3", (0.36, 0.5, TOP + 0.2), (0.1, 0.1, 0.1)),
    box("wedge1", (-0.3, 0.3, TOP), (0.2, 0.1, 0.05), turn=TILTED),
    # under and beside it
    box("case1", (0.0, 0.0, 0.0), (0.4, 0.3, 0.3)), box("case2", (0.0, 0.0, 0.3), (0.2, 0.2, 0.1)),
    thing("chair1", (0.55, 0.0, 0.0), yaw=math.pi), thing("bucket1", (-2.0, -2.0, 0.0)),
    box("stick1", (-2.0, -2.0, 0.02), (0.02, 0.02, 1.0)), box("board1", (-2.0, -1.6, 0.0), (0.02, 0.4, 0.5)),
    # containers
    thing("fridge1", (2.0, -2.0, 0.0)), thing("milk1", (2.0, -2.0, 0.867), "carton"),
    thing("shelf1", (-2.0, 0.0, 0.0), "bookshelf"), thing("can1", (-1.0, -1.0, 0.0)),
    thing("egg1", (-1.0, -1.0, 0.02)),
    thing("chest1", (1.0, 2.0, 0.0), "drawer"),
    # walls
    thing("wall1", (0.0, 2.5, 0.0), size=(0.1, 4.0, 2.5), turn=(0.7071068, 0.0, 0.0, 0.7071068)),
    thing("picture1", (0.0, 2.43, 1.4), turn=QUARTER),
    box("pole1", (-0.5, 2.2, 0.0), (0.04, 0.04, 1.2), turn=(math.cos(-0.1), math.sin(-0.1), 0.0, 0.0)),
    box("crate1", (0.6, 2.3, 0.0), (0.3, 0.3, 0.4)), box("crate2", (0.6, 1.95, 0.0), (0.3, 0.3, 0.4)),
    box("crate3", (0.6, 1.6, 0.0), (0.3, 0.3, 0.4)), box("lid1", (0.6, 2.12, 0.4), (0.25, 0.6, 0.03)),
    # without a size
    thing("thing1", (1.0, 1.0, 0.0), "unheard of"), thing("mug9", None),
)  # fmt: skip
