"""Alternative models of classes, and how one is chosen.

The TBox names one model per class. Among it and its alternatives, an entity gets the one that its name says,
or else the nearest in size (`ontology/model_choice.py`).
"""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.sim_node.models.catalogue import other_forms, tableware
from semmap.nodes.sim_node.models.model_table import MODELS, ModelKind


class Variety(NamedTuple):
    """A model, and the models `of` classes to which it is an alternative.

    `words` are its names within an entity's name, in addition to its own; each may be several words. One that
    is `only_named` cannot be distinguished by size.
    """

    kind: ModelKind
    of: tuple[str, ...]
    words: tuple[str, ...] = ()
    only_named: bool = False


_K, _V = ModelKind, Variety
_O, _T = other_forms, tableware
_CARTONS = ("cardboard_box", "box", "carton")
_PACKET = ("carton", "packet", "package", "pacco")

# fmt: off
VARIETIES: dict[str, Variety] = {
    "small_carton": _V(_K(_O.packet, (0.14, 0.20, 0.12), 0.5, (0.62, 0.40, 0.30)), _CARTONS, _PACKET),
    "flat_carton": _V(_K(_O.packet, (0.17, 0.25, 0.05), 0.4, (0.30, 0.46, 0.58)), _CARTONS, _PACKET),
    "upright_carton": _V(_K(_O.packet, (0.08, 0.14, 0.20), 0.5, (0.72, 0.30, 0.26)), _CARTONS, _PACKET),
    "flat_bottle": _V(_K(_O.flat_bottle, (0.045, 0.085, 0.20), 0.45, (0.86, 0.62, 0.20)), ("bottle",),
        ("shampoo", "lotion", "ketchup", "detergent")),
    "spray_bottle": _V(_K(_O.spray_bottle, (0.095, 0.080, 0.25), 0.6, (0.30, 0.62, 0.80)), ("bottle",),
        ("spray", "sprayer", "spruzzino"), only_named=True),
    "flat_can": _V(_K(_T.can, (0.085, 0.085, 0.040), 0.2, (0.20, 0.36, 0.62)), ("can",),
        ("tuna", "sardines", "tonno")),
    "wide_can": _V(_K(_T.can, (0.100, 0.100, 0.120), 0.8, (0.80, 0.62, 0.20)), ("can",)),
    "drink_can": _V(_K(_O.drink_can, (0.066, 0.066, 0.122), 0.35, (0.80, 0.12, 0.14)), ("can",),
        ("drink", "beer", "coke", "cola", "soda", "lemonade"), only_named=True),
    "espresso_cup": _V(_K(_T.cup, (0.058, 0.082, 0.055), 0.12, (0.93, 0.93, 0.90)), ("cup",),
        ("espresso", "tazzina")),
    "tumbler": _V(_K(_O.tumbler, (0.080, 0.080, 0.100), 0.2, (0.45, 0.60, 0.45)), ("cup",),
        ("beaker", "bicchiere")),
    "wine_glass": _V(_K(_O.wine_glass, (0.080, 0.080, 0.200), 0.2, (0.74, 0.86, 0.92)), ("glass",),
        ("wine", "goblet", "calice", "vino")),
    "tall_glass": _V(_K(_T.glass, (0.065, 0.065, 0.150), 0.3, (0.70, 0.85, 0.92)), ("glass",), ("highball",)),
    "small_glass": _V(_K(_T.glass, (0.048, 0.048, 0.060), 0.1, (0.70, 0.85, 0.92)), ("glass",), ("shot",)),
    "side_plate": _V(_K(_T.plate, (0.175, 0.175, 0.020), 0.25, (0.93, 0.94, 0.90)), ("plate",),
        ("dessert plate", "saucer", "piattino")),
    "skillet": _V(_K(_O.skillet, (0.42, 0.26, 0.050), 1.2, (0.15, 0.15, 0.16)), ("pan",),
        ("frying", "padella"), only_named=True),
    "teapot": _V(_K(_O.steady_teapot, (0.14, 0.226, 0.145), 0.8, (0.88, 0.86, 0.78)), ("kettle",),
        ("teiera",)),
    "standing_book": _V(_K(_O.standing_book, (0.16, 0.035, 0.23), 0.5, (0.18, 0.34, 0.30)), ("book",),
        ("upright book",)),
    "table_tennis_ball": _V(_K(_O.plain_ball, (0.040, 0.040, 0.040), 0.003, (0.95, 0.95, 0.93)), ("ball",),
        ("ping pong", "golf")),
    "tennis_ball": _V(_K(_O.plain_ball, (0.067, 0.067, 0.067), 0.058, (0.80, 0.90, 0.25)), ("ball",),
        ("tennis",)),
    "toy_ball": _V(_K(_O.plain_ball, (0.120, 0.120, 0.120), 0.1, (0.85, 0.25, 0.22)), ("ball",)),
    "basketball": _V(_K(_O.plain_ball, (0.245, 0.245, 0.245), 0.62, (0.85, 0.42, 0.16)), ("ball",)),
    # models of other classes
    "wine_bottle": _V(MODELS["wine_bottle"], ("bottle",), ("wine", "vino"), only_named=True),
    "cereals": _V(MODELS["cereals"], _CARTONS[:2], ("cereal", "cornflakes", "muesli"), only_named=True),
    "magazine": _V(MODELS["magazine"], ("book",), ("rivista",), only_named=True),
    "floor_lamp": _V(MODELS["floor_lamp"], ("lamp",)),
}
# fmt: on

KINDS: dict[str, ModelKind] = MODELS | {name: variety.kind for name, variety in VARIETIES.items()}
"""All models of the library."""
