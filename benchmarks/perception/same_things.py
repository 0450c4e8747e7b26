"""Things of the real frames that are in two frames or more, by eye."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Look(NamedTuple):
    """A thing in a frame: the name of the frame, and the number of the object in its `truth.json`, from 0."""

    frame: str
    number: int


def _looks(text: str, prefix: str = "") -> tuple[Look, ...]:
    """Return the looks of `FRAME:NUMBER ...`."""
    pairs = (look.split(":") for look in text.split())
    return tuple(Look(prefix + frame, int(number)) for frame, number in pairs)


_TABLES = {
    "red_cereals": "0:0 2:1 4:1 6:1 8:0 10:1 12:1 14:1 21:1 22:2 23:1 24:1 27:0 28:1 31:1 32:0",
    "orange_cereals": "2:0 4:0 12:0 14:0 17:1 18:0 19:1 20:1 21:2 22:1 23:2 24:0 29:0",
    "yellow_cereals": "17:0 18:1 19:0 20:0 21:0 22:0 23:0 24:2 27:1 28:0 29:1",
    "fruit_cereals": "25:1 26:0",
    "blue_cereals": "25:0 26:1",
    "tea": "6:0 8:1 10:0 14:2",
    "crisps": "30:1 31:0 32:1 43:0 44:1",
    "biscuit_tin": "33:0 34:0 35:1 36:0 37:0 38:2 39:0 40:0 41:0 42:0 43:1 44:0",
    "yellow_pot": "33:1 34:1 35:0 36:2 37:2 38:3 39:3 40:2 41:1",
    "white_bowl": "33:2 34:2 35:2 36:1 37:1",
    "printed_cup": "33:3 38:1 39:2 44:2",
    "white_cup": "33:4 38:0 39:1",
    "flowered_jar": "40:1 42:1",
}
"""The frames of `mosd/`, without the prefix of their names."""

_OTHERS = {
    "whisk": "arc_0:0 arc_1:0",
    "torch": "arc_0:1 arc_1:1",
    "pink_scissors": "arc_0:2 arc_1:2",
    "geode": "cleargrasp_123:0 cleargrasp_130:0",
    "blue_lid": "cleargrasp_123:1 cleargrasp_130:1",
    "power_drill": "posecnn_1:0 posecnn_5:2",
    "crackers": "posecnn_1:2 posecnn_5:0",
    "mustard": "posecnn_1:3 posecnn_4:1",
    "soup": "posecnn_1:4 posecnn_2:2 posecnn_3:1",
    "cleanser": "posecnn_2:0 posecnn_5:1",
    "sugar": "posecnn_2:3 posecnn_5:3",
    "numbered_carton": "planes_0:0 planes_1:4 planes_2:2 planes_9:5",
    "cooker_carton": "planes_1:1 planes_2:0 planes_4:1 planes_8:0 planes_9:2",
    "long_carton": "planes_1:0 planes_4:0 planes_9:1",
    "white_bag": "planes_1:2 planes_2:1 planes_4:2 planes_8:1 planes_9:3",
    "backpack": "planes_1:3 planes_4:3 planes_8:2 planes_9:4",
    "slippers": "planes_4:6 planes_6:3 planes_8:4",
    "printed_box": "planes_2:3 planes_6:1 planes_7:3",
}

THINGS: Mapping[str, tuple[Look, ...]] = {
    **{name: _looks(text, "mosd_") for name, text in _TABLES.items()},
    **{name: _looks(text) for name, text in _OTHERS.items()},
}
"""The looks of each thing. Things that cannot be told from others of their kind are left out."""
