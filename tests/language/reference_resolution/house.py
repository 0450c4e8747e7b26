"""A house of three rooms for resolving descriptions, with given instead of computed relations.

The viewer is anna, in the living room at the origin, and looks along x.
"""

from semmap.nodes.language.reference_resolution.map_index import MapIndex, Terms
from tests.language.reference_resolution.kitchen import Written, item

CLASSES = {
    "Thing": ("thing", "cosa"), "Kitchen": ("kitchen", "cucina"), "Bedroom": ("bedroom", "camera da letto"),
    "Livingroom": ("living room", "soggiorno"), "Door": ("door", "porta"), "Window": ("window", "finestra"),
    "Cabinet": ("cabinet", "armadietto"), "Drawer": ("drawer", "cassetto"), "Shelf": ("shelf", "scaffale"),
    "Book": ("book", "libro"), "Chair": ("chair", "sedia"), "Table": ("table", "tavolo"),
    "Box": ("box", "scatola"), "Bottle": ("bottle", "bottiglia"), "Glass": ("glass", "bicchiere"),
    "Water": ("water", "acqua"), "Juice": ("juice", "succo"), "Person": ("person", "persona"),
    "Lamp": ("lamp", "lampada"), "Drink": ("drink", "bevanda"), "Furniture": ("furniture", "mobile"),
    "Scissors": ("scissors", "forbici"), "Bed": ("bed", "letto"),
}  # fmt: skip
COLOURS = {"red": "rosso", "blue": "blu", "green": "verde", "white": "bianco"}
MATERIALS = {"wood": "legno", "glass": "vetro", "metal": "metallo"}
TERMS = Terms(
    tuple(
        (tag, name, text)
        for name, pair in CLASSES.items()
        for tag, text in zip(("en", "it"), pair, strict=True)
    ),
    tuple(
        (tag, f"{kind}_{english}", text)
        for kind, words in (("color", COLOURS), ("material", MATERIALS))
        for english, italian in words.items()
        for tag, text in (("en", english), ("it", italian))
    ),
    (
        ("en", "drinking", "drinking it"), ("it", "drinking", "bere"), ("en", "sitting", "sitting on it"),
        ("it", "sitting", "sedersi"), ("en", "reading", "reading it"), ("it", "reading", "leggere"),
        ("en", "cutting", "cutting with it"), ("en", "storing", "storing things"),
    ),
    {
        "Drink": frozenset(("drinking",)), "Chair": frozenset(("sitting",)), "Book": frozenset(("reading",)),
        "Scissors": frozenset(("cutting",)), "Box": frozenset(("storing",)),
    },
)  # fmt: skip


def red(name, class_name, *references, **values):
    """Return a red thing."""
    return item(name, class_name, *references, hasColor="color_red", **values)


ITEMS = (
    item("kitchen1", "Kitchen", place=True, isAdjacentTo="livingroom1"),
    item("livingroom1", "Livingroom", "lounge", place=True),
    item("bedroom1", "Bedroom", place=True),
    item("anna", "Person", "Anna"), item("bob", "Person", "Bob"),
    item("door1", "Door", "front door", connects="livingroom1", isOpen=False),
    item("door2", "Door", connects="kitchen1", isOpen=True), item("door3", "Door", connects="bedroom1"),
    item("window1", "Window", isOpen=True), item("window2", "Window", isOpen=False),
    item("cabinet1", "Cabinet", types=("Furniture",), hasMaterial="material_wood"),
    item("drawer1", "Drawer", isPartOf="cabinet1", isOpen=False),
    item("drawer2", "Drawer", isPartOf="cabinet1", isOpen=True),
    item("drawer3", "Drawer", isPartOf="cabinet1", isOpen=False),
    item("shelf1", "Shelf", types=("Furniture",), hasMaterial="material_wood"),
    red("book1", "Book", "Emma", isOwnedBy="anna"), red("book2", "Book", isOwnedBy="bob"),
    item("book3", "Book", hasColor="color_blue"),
    item("table1", "Table", types=("Furniture",), hasMaterial="material_wood"),
    item("table2", "Table", types=("Furniture",), hasMaterial="material_glass"),
    red("chair1", "Chair", types=("Furniture",)), red("chair2", "Chair", types=("Furniture",)),
    item("chair3", "Chair", types=("Furniture",), hasColor="color_green"),
    item("chair4", "Chair", types=("Furniture",), hasColor="color_white"),
    item("box1", "Box"), item("box2", "Box"), item("box3", "Box", hasColor="color_blue"),
    item("bottle1", "Bottle", hasMaterial="material_glass"), item("bottle2", "Bottle"),
    item("water1", "Water", types=("Drink",)), item("juice1", "Juice", types=("Drink",)),
    item("glass1", "Glass", hasMaterial="material_glass"), item("glass2", "Glass"),
    item("lamp1", "Lamp", isSwitchedOn=True), item("lamp2", "Lamp", isSwitchedOn=False),
    item("lamp3", "Lamp"), item("scissors1", "Scissors"), item("bed1", "Bed", types=("Furniture",)),
)  # fmt: skip
AT = {
    "livingroom1": (3, 0, 0), "kitchen1": (3, 8, 0), "bedroom1": (3, -8, 0), "anna": (0, 0, 0),
    "bob": (2, 9, 0),
    "door1": (6, 0, 0), "door2": (3, 4, 0), "door3": (3, -4, 0), "window1": (6, 2, 1), "window2": (6, -2, 1),
    "cabinet1": (1, 8, 0), "drawer1": (1, 8, 0.2), "drawer2": (1, 8, 0.5), "drawer3": (1, 8, 0.8),
    "shelf1": (5, 3, 0), "book1": (5, 3, 1), "book2": (5, 3, 1.5), "book3": (2, 0, 0.8),
    "table1": (2, 0, 0), "table2": (2, 8, 0), "chair1": (3, 2, 0), "chair2": (3, 1, 0), "chair3": (3, -1, 0),
    "chair4": (-2, 0, 0), "box1": (4, -9, 0), "box2": (4, -9, 0.5), "box3": (5, -9, 0),
    "bottle1": (2, 8, 0.8),
    "bottle2": (2.2, 8, 0.8), "water1": (2, 8, 0.8), "juice1": (2.2, 8, 0.8), "glass1": (1.9, 0.1, 0.8),
    "glass2": (2, 8.2, 0.8), "lamp1": (2, 0.3, 0.8), "lamp2": (4, -7, 0.8), "lamp3": (2, 7.8, 0.8),
    "scissors1": (1, 8, 0.5), "bed1": (3, -8, 0),
}  # fmt: skip
INSIDE = {
    "livingroom1": ("anna door1 window1 window2 shelf1 book1 book2 book3 table1 chair1 chair2 chair3 chair4"
                    " glass1 lamp1"),
    "kitchen1": ("bob cabinet1 drawer1 drawer2 drawer3 table2 bottle1 bottle2 water1 juice1 glass2 lamp3"
                 " scissors1"),
    "bedroom1": "box1 box2 box3 lamp2 bed1", "bottle1": "water1", "bottle2": "juice1", "drawer2": "scissors1",
}  # fmt: skip
ON = {
    "shelf1": "book1 book2", "table1": "book3 glass1 lamp1", "table2": "bottle1 bottle2 glass2 lamp3",
    "box1": "box2", "bed1": "lamp2",
}  # fmt: skip
BESIDE = (("book3", "glass1"), ("glass1", "lamp1"), ("chair1", "chair2"), ("bottle1", "glass2"),
          ("box1", "box3"), ("chair3", "table1"), ("bottle1", "bottle2"))  # fmt: skip
LEFT_OF = (("chair1", "chair2"), ("chair2", "chair3"), ("chair1", "chair3"), ("window1", "door1"))
STACK = ("drawer1", "drawer2", "drawer3")
HOLDS = {
    *(("isInside", name, holder) for holder, names in INSIDE.items() for name in names.split()),
    *(("isOn", name, holder) for holder, names in ON.items() for name in names.split()),
    *(("isNextTo", *pair) for one, other in BESIDE for pair in ((one, other), (other, one))),
    *(("isNear", *pair) for one, other in BESIDE for pair in ((one, other), (other, one))),
    *(("isLeftOf", one, other) for one, other in LEFT_OF),
    *(("isRightOf", other, one) for one, other in LEFT_OF),
    *(("isAbove", STACK[j], STACK[i]) for i in range(3) for j in range(i + 1, 3)),
    *(("isUnder", STACK[i], STACK[j]) for i in range(3) for j in range(i + 1, 3)),
    ("isUnder", "box3", "bed1"), ("isBehind", "chair4", "table1"), ("isInFrontOf", "chair3", "table1"),
}  # fmt: skip
SIZES = {
    "book1": (0.2, 0.15, 0.02), "book2": (0.3, 0.2, 0.05), "book3": (0.2, 0.15, 0.03),
    "table1": (1.2, 0.8, 0.75), "table2": (2.0, 0.9, 0.75), "box1": (0.5, 0.5, 0.5), "box2": (0.3, 0.3, 0.3),
    "box3": (0.2, 0.2, 0.6), "bottle1": (0.08, 0.08, 0.3), "bottle2": (0.1, 0.1, 0.2),
    "glass1": (0.06, 0.06, 0.1), "glass2": (0.06, 0.06, 0.1), "lamp1": (0.2, 0.2, 0.5),
    "lamp2": (0.2, 0.2, 0.3), "lamp3": (0.4, 0.2, 0.5), "chair1": (0.5, 0.5, 0.9), "chair2": (0.5, 0.5, 0.9),
    "chair3": (0.6, 0.5, 0.9), "chair4": (0.5, 0.5, 0.9), "shelf1": (1.0, 0.3, 2.0), "bed1": (2.0, 1.6, 0.5),
}  # fmt: skip
BETWEEN = {frozenset(("chair1", "chair3")): {"chair2"}, frozenset(("book3", "lamp1")): {"glass1"},
           frozenset(("window1", "window2")): {"door1"}}  # fmt: skip


class House(Written):
    """The MapGeometry of the house."""

    at, holds, sizes, viewer = AT, HOLDS, SIZES, "anna"

    def between(self, one, other):
        return frozenset(BETWEEN.get(frozenset((one, other)), ()))


def known():
    made = MapIndex(TERMS)
    made.update(ITEMS)
    return made
