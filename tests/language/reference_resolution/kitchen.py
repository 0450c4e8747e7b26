"""A small kitchen for resolving descriptions, with given instead of computed relations."""

import math
from typing import ClassVar

from semmap.nodes.language.reference_resolution.map_index import Item, MapIndex, Terms
from semmap.nodes.language.reference_resolution.resolution import find
from semmap.schemas import errors

CLASSES = {
    "Thing": ("thing", "cosa"),
    "Cup": ("cup", "tazza"),
    "Table": ("table", "tavolo"),
    "Sink": ("sink", "lavandino"),
    "Kitchen": ("kitchen", "cucina"),
    "Fridge": ("fridge", "frigorifero"),
    "Bottle": ("bottle", "bottiglia"),
    "Drink": ("drink", "bevanda"),
    "Wine": ("wine", "vino"),
    "Person": ("person", "persona"),
    "Glasses": ("glasses", "occhiali"),
    "Glass": ("glass", "bicchiere"),
    "Monitor": ("monitor", "monitor"),
    "Cat": ("cat", "gatto"),
    "Floor_Lamp": ("floor lamp", "lampada da terra"),
}
TERMS = Terms(
    tuple(
        (tag, name, text)
        for name, pair in CLASSES.items()
        for tag, text in zip(("en", "it"), pair, strict=True)
    ),
    (
        *(("en", "color_red", "red"), ("it", "color_red", "rosso"), ("en", "color_blue", "blue")),
        *(("it", "color_blue", "blu"), ("en", "material_glass", "glass"), ("it", "material_glass", "vetro")),
    ),
    (("en", "drinking", "drinking it"), ("it", "drinking", "bere"), ("en", "seeing", "seeing")),
    {"Drink": frozenset(("drinking",))},
)


def item(name, class_name, *references, types=(), place=False, **values):
    """An entity with properties of one value each."""
    said = {key: frozenset((value,)) for key, value in values.items()}
    return Item(name, class_name, frozenset((class_name, "Thing", *types)), references, said, place)


ITEMS = (
    item("kitchen1", "Kitchen", place=True),
    item("table1", "Table"),
    item("sink1", "Sink"),
    item("fridge1", "Fridge", isOpen=False),
    item("cup1", "Cup", "cup", hasColor="color_red", mass=0.2),
    item("cup2", "Cup", "cup", hasColor="color_blue", mass="0.4"),
    item("cup3", "Cup", "favourite mug", hasColor="color_red", isOwnedBy="anna", mass=0.3),
    item("anna", "Person", "Anna"),
    item("wine1", "Wine", "bottle of wine", types=("Drink",)),
    item("lamp1", "Floor_Lamp", isSwitchedOn=True),
    item("glasses1", "Glasses", "glasses", isOwnedBy="anna"),
)
AT: dict[str, tuple[float, float, float]] = {
    "kitchen1": (0, 0, 0), "table1": (0, 0, 0),
    "cup1": (0, 0, 1), "cup2": (0, 1, 1), "cup3": (5, 0, 1), "sink1": (5, 0, 0),
    "fridge1": (9, 0, 0), "wine1": (9, 0, 1), "anna": (-3, 0, 0), "lamp1": (3, 3, 0), "glasses1": (0, 2, 1),
}  # fmt: skip
HOLDS = {
    ("isOn", "cup1", "table1"), ("isOn", "cup2", "table1"), ("isInside", "cup3", "sink1"),
    ("isInside", "wine1", "fridge1"), ("isNextTo", "cup1", "cup2"), ("isNextTo", "cup2", "cup1"),
    ("isLeaningAgainst", "lamp1", "fridge1"),
    *(("isInside", name, "kitchen1") for name in AT),
}  # fmt: skip
SIZES = {"cup1": 0.1, "cup2": 0.1, "cup3": 0.2}


class Written:
    """A MapGeometry with given positions, sizes and relations; the viewer looks along x."""

    at: ClassVar[dict[str, tuple[float, float, float]]] = AT
    sizes: ClassVar[dict[str, tuple[float, float, float]]] = {n: (m, m, m) for n, m in SIZES.items()}
    holds, viewer = HOLDS, "anna"

    def __init__(self, has_viewer=False):
        self.has_viewer = has_viewer

    def related(self, relation, name, other):
        return (relation, name, other) in self.holds

    def between(self, one, other):
        return frozenset(("cup2",) if {one, other} == {"cup1", "glasses1"} else ())

    def position(self, name):
        return self.at.get(name)

    def size(self, name):
        return self.sizes.get(name)

    def distance(self, name, other):
        return math.dist(self.at[name][:2], self.at[other][:2])

    def distance_from_viewer(self, name):
        return self.distance(name, self.viewer)

    def bearing(self, name):
        if not self.has_viewer:
            raise errors.BadRequest("there is no viewer")
        (x, y, _), (from_x, from_y, _) = self.at[name], self.at[self.viewer]
        return math.atan2(y - from_y, x - from_x)

    def holds_anything(self, name):
        return any(other == name for _, _, other in self.holds)

    def is_on_floor(self, name):
        return self.at[name][2] == 0

    def spatial_relations(self, name):
        places = ("kitchen1", "livingroom1", "bedroom1")
        given = sorted(self.holds)
        return tuple((r, other) for r, one, other in given if one == name and other not in places)


def known():
    made = MapIndex(TERMS)
    made.update(ITEMS)
    return made


def found(text, asker=None, has_viewer=False):
    """Return outcome and names."""
    answer = find(text, known(), Written(has_viewer), asker)
    return answer.outcome, set(answer.names)
