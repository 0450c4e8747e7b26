"""Manually created situations with the relations that a person would state.

`tests/kb_node/relations/test_situations.py` checks the relations against them, and `picture` draws them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from semmap.ontology.model_shapes import own_size_m, shapes
from semmap.schemas.entities import Entity, Pose, Provenance, Quaternion, Size, Vector, orientation_from_yaw

_NOBODY = Provenance(commit=1, stamp_ns=0, source="file")

Said = tuple[str, str, str]
"""Name, relation, name."""


class Situation(NamedTuple):
    """Some things with their relations."""

    title: str
    things: tuple[Entity, ...]
    said: frozenset[Said]
    """All support, containment and attachment relations, and those with places if there are any."""
    also: frozenset[Said] = frozenset()
    """The most salient other relations."""
    never: frozenset[Said] = frozenset()
    """Plausible but wrong relations."""


def thing(
    name: str,
    at: Vector,
    *,
    yaw: float = 0.0,
    turn: Quaternion | None = None,
    size: Size | None = None,
    fixed: bool = False,
) -> Entity:
    """Create a thing by its model's name and a number; with a size and without such a model, a box."""
    model = name.rstrip("0123456789")
    known = model in shapes()
    return Entity(
        name=name, class_=model.title(), iri=f"urn:{name}", types=(), model=model if known else "",
        fixed=fixed,
        pose=Pose(position_m=at, orientation_wxyz=turn or orientation_from_yaw(yaw)),
        size_m=size or (own_size_m(model) if known else None), provenance=_NOBODY,
        pose_provenance=_NOBODY, shape_provenance=_NOBODY, reference_provenance=_NOBODY,
    )  # fmt: skip


def place(name: str, at: Vector, size: Size) -> Entity:
    """Create a room or a part of one."""
    return Entity(
        name=name, class_="Location", iri=f"urn:{name}", types=(), place=True, size_m=size,
        pose=Pose(position_m=at), provenance=_NOBODY, pose_provenance=_NOBODY, shape_provenance=_NOBODY,
        reference_provenance=_NOBODY,
    )  # fmt: skip


def situation(title: str, *things: Entity, said: str = "", also: str = "", never: str = "") -> Situation:
    """Parse facts such as "cup1 isOn table1, table1 isOn rug1"."""
    return Situation(title, things, _facts(said), _facts(also), _facts(never))


def _facts(text: str) -> frozenset[Said]:
    words = [part.split() for part in text.split(",") if part.strip()]
    return frozenset((name, relation, other) for name, relation, other in words)


def about_y(degrees: float) -> Quaternion:
    """Return a rotation about the y axis, which tilts the top towards +x."""
    half = math.radians(degrees) / 2
    return (math.cos(half), 0.0, math.sin(half), 0.0)


def surface(model: str, nth: int = 0) -> float:
    """Return the height of a model's surface, counted from above [m]."""
    return shapes()[model].surfaces[nth].height


def tall(model: str) -> float:
    """Return a model's height [m]."""
    return shapes()[model].size_m[2]


def seat(model: str) -> float:
    """Return the height of a model's lowest surface, such as a seat [m]."""
    return surface(model, -1)


TOP = tall("table")
TABLE = thing("table1", (0.0, 0.0, 0.0))
WALL = thing("wall1", (-0.9, 0.0, 0.0), size=(0.1, 3.0, 2.5))
FRIDGE = thing("fridge1", (0.0, 0.0, 0.0))
SHELVES = thing("bookshelf1", (0.0, 0.0, 0.0))
BOWL = thing("bowl1", (0.0, 0.0, TOP))
BLOCK = (0.2, 0.2, 0.1)
COUCH = thing("couch1", (0.0, 0.0, 0.0))
CHAIR = thing("chair1", (0.0, 0.0, 0.0))
BUCKET = thing("bucket1", (0.0, 0.0, 0.0))
ROOM = place("room1", (0.0, 0.0, 0.0), (4.0, 4.0, 2.5))


def on_table(name: str, x: float = 0.0, y: float = 0.0, z: float = 0.0, **fields: object) -> Entity:
    """Place a thing on the table, or `z` above its top."""
    return thing(name, (x, y, TOP + z), **fields)  # type: ignore[arg-type]


def _leaning(name: str, foot_x: float, degrees: float) -> Entity:
    """Place a thin upright thing with its lower +x edge at a point on the table, tilted towards -x."""
    x, _, _ = own_size_m(name.rstrip("0123456789")) or (0.0, 0.0, 0.0)
    lean = math.radians(degrees)
    return on_table(name, foot_x - x / 2 * math.cos(lean), 0.0, x / 2 * math.sin(lean), turn=about_y(degrees))


def _ramp(name: str, rise_m: float, run_m: float) -> Entity:
    """Place a flat thing with its lower edge on the table at x = 0, leaning on an edge."""
    x, _, _ = own_size_m(name.rstrip("0123456789")) or (0.0, 0.0, 0.0)
    lean = math.atan2(rise_m, run_m)
    return on_table(
        name, x / 2 * math.cos(lean), 0.0, x / 2 * math.sin(lean), turn=about_y(-math.degrees(lean))
    )


def _in(model: str, level: int) -> float:
    """Return the height of a board inside a model, the lowest first."""
    return sorted(s.height for s in shapes()[model].surfaces)[level]


SITUATIONS: tuple[Situation, ...] = (
    situation("on a table", TABLE, on_table("cup1"), said="cup1 isOn table1"),
    situation("let go two centimetres above it", TABLE, on_table("cup1", z=0.02), said="cup1 isOn table1"),
    situation("sunk a centimetre into it", TABLE, on_table("cup1", z=-0.01), said="cup1 isOn table1"),
    situation("in the air above it", TABLE, on_table("cup1", z=0.2), also="cup1 isAbove table1"),
    situation("under it", TABLE, thing("ball1", (0.0, 0.0, 0.0)), also="ball1 isUnder table1"),
    situation("beside it, at its height", TABLE, on_table("cup1", x=0.6)),
    situation("half over the edge", TABLE, on_table("box1", x=0.4, size=BLOCK), said="box1 isOn table1"),
    situation("nearly all of it over the edge", TABLE, on_table("box1", x=0.48, size=BLOCK)),
    situation("tilted a little", TABLE, on_table("can1", turn=about_y(4.0)), said="can1 isOn table1"),
    situation(
        "lying on its side",
        TABLE, on_table("bottle1", x=-0.14, z=0.0404, turn=about_y(90.0)),
        said="bottle1 isOn table1",
    ),
    situation(
        "on a book on a table",
        TABLE, on_table("book1"), on_table("cup1", z=0.03),
        said="book1 isOn table1, cup1 isOn book1", never="cup1 isOn table1",
    ),
    situation(
        "a stack of three",
        TABLE, *(on_table(f"box{n}", z=0.1 * (n - 1), yaw=0.2 * n, size=BLOCK) for n in (1, 2, 3)),
        said="box1 isOn table1, box2 isOn box1, box3 isOn box2",
    ),
    situation(
        "a large one on a small one",
        TABLE, on_table("can1"), on_table("tray1", z=tall("can")),
        said="can1 isOn table1, tray1 isOn can1", also="can1 isUnder tray1",
    ),
    situation(
        "askew on another",
        TABLE, on_table("box1", size=BLOCK), on_table("box2", x=0.1, z=0.1, size=BLOCK),
        said="box1 isOn table1, box2 isOn box1",
    ),
    situation(
        "a board across two boxes",
        TABLE, on_table("box1", y=-0.2, size=BLOCK), on_table("box2", y=0.2, size=BLOCK),
        on_table("board1", z=0.1, size=(0.15, 0.55, 0.02)),
        said="box1 isOn table1, box2 isOn table1, board1 isOn box1, board1 isOn box2",
    ),
    situation(
        "over the gap of two tables",
        TABLE, thing("table2", (0.0, 1.25, 0.0)), on_table("box1", y=0.625, size=(0.3, 0.4, 0.2)),
        said="box1 isOn table1, box1 isOn table2",
    ),
    situation(
        "a book leaning on a box",
        TABLE, on_table("box1", x=-0.15, size=(0.1, 0.2, 0.3)), _leaning("book1", 0.0, 62.0),
        said="box1 isOn table1, book1 isOn table1", also="book1 isLeaningAgainst box1",
        never="book1 isOn box1",
    ),
    situation(
        "a tray tilted over the edge of a box",
        TABLE, on_table("box1", x=0.2, size=(0.1, 0.3, 0.05)), _ramp("tray1", 0.05, 0.15),
        said="box1 isOn table1, tray1 isOn table1, tray1 isOn box1",
    ),
    situation("an orange in a bowl", TABLE, BOWL, on_table("orange1", z=0.011),
              said="bowl1 isOn table1, orange1 isInside bowl1", never="orange1 isOn bowl1"),
    situation("a ball on a box", TABLE, on_table("box1", size=BLOCK), on_table("ball1", z=0.1),
              said="box1 isOn table1, ball1 isOn box1", never="ball1 isOn table1"),
    situation("a tray on two cans", TABLE, on_table("can1", y=-0.15), on_table("can2", y=0.15),
              on_table("tray1", z=tall("can")),
              said="can1 isOn table1, can2 isOn table1, tray1 isOn can1, tray1 isOn can2"),
    situation("a pen in a glass", TABLE, on_table("glass1"),
              on_table("pen1", x=-0.006, z=0.082, turn=about_y(90.0)),
              said="glass1 isOn table1, pen1 isInside glass1"),
    situation(
        "a bottle that looks out of a basket",
        TABLE, on_table("basket1"), on_table("bottle1", z=0.012),
        said="basket1 isOn table1, bottle1 isInside basket1",
    ),
    situation(
        "one orange on another in a basket",
        TABLE, on_table("basket1"), on_table("orange1", z=0.012), on_table("orange2", z=0.09),
        said="basket1 isOn table1, orange1 isInside basket1, orange2 isInside basket1, orange2 isOn orange1",
    ),
    situation(
        "glasses on a tray",
        TABLE, on_table("tray1"), on_table("glass1", y=-0.1, z=0.01), on_table("glass2", y=0.1, z=0.01),
        said="tray1 isOn table1, glass1 isOn tray1, glass2 isOn tray1",
    ),
    situation(
        "a bowl on a plate, with an egg",
        TABLE, on_table("plate1"), on_table("bowl1", z=0.018), on_table("egg1", z=0.03),
        said="plate1 isOn table1, bowl1 isOn plate1, egg1 isInside bowl1",
    ),
    situation("a tomato in a bin", thing("bin1", (0.0, 0.0, 0.0)), thing("tomato1", (0.0, 0.0, 0.011)),
              said="tomato1 isInside bin1"),
    *(
        situation(
            f"on board {nth + 1} of a bookshelf" if nth < 5 else "on top of a bookshelf",
            SHELVES, thing("book1", (0.0, 0.0, _in("bookshelf", nth))), said="book1 isOn bookshelf1",
        )
        for nth in (0, 2, 5)
    ),
    situation(
        "milk on a board of the fridge",
        FRIDGE, thing("carton1", (0.0, 0.0, _in("fridge", 2))),
        said="carton1 isInside fridge1", never="carton1 isOn fridge1",
    ),
    situation("peas in its freezer", FRIDGE, thing("box1", (0.0, 0.0, _in("fridge", 4)), size=BLOCK),
              said="box1 isInside fridge1"),
    situation("a basket on top of it", FRIDGE, thing("basket1", (0.0, 0.0, tall("fridge"))),
              said="basket1 isOn fridge1"),
    situation("keys in a drawer", thing("drawer1", (0.0, 0.0, 0.0)),
              thing("keys1", (0.0, 0.1, _in("drawer", 2))), said="keys1 isInside drawer1"),
    situation("plates in a cupboard", thing("cupboard1", (0.0, 0.0, 0.0)),
              thing("plate1", (0.0, 0.0, _in("cupboard", 1))),
              thing("plate2", (0.0, 0.0, _in("cupboard", 1) + 0.018)),
              said="plate1 isInside cupboard1, plate2 isInside cupboard1, plate2 isOn plate1"),
    situation("a cup in the dishwasher", thing("dishwasher1", (0.0, 0.0, 0.0)),
              thing("cup1", (0.0, 0.0, _in("dishwasher", 1))), said="cup1 isInside dishwasher1"),
    situation("a tray in the oven", thing("oven1", (0.0, 0.0, 0.0)),
              thing("tray1", (0.0, 0.0, _in("oven", 1))), said="tray1 isInside oven1"),
    situation("a pot on the stove on the counter", thing("counter1", (0.0, 0.0, 0.0)),
              thing("stove1", (0.0, 0.4, tall("counter"))),
              thing("pot1", (-0.1, 0.3, tall("counter") + surface("stove"))),
              said="stove1 isOn counter1, pot1 isOn stove1"),
    situation("on a chair's seat", thing("chair1", (0.0, 0.0, 0.0)),
              thing("cushion1", (0.03, 0.0, surface("chair", -1))), said="cushion1 isOn chair1"),
    situation("on the seat of a couch", thing("couch1", (0.0, 0.0, 0.0)),
              thing("book1", (0.15, 0.3, surface("couch", -1))), said="book1 isOn couch1"),
    situation("a pillow on a bed", thing("bed1", (0.0, 0.0, 0.0)),
              thing("pillow1", (-0.6, 0.3, surface("bed", -1))), said="pillow1 isOn bed1"),
    situation("a ball in the bathtub", thing("bathtub1", (0.0, 0.0, 0.0)), thing("ball1", (0.0, 0.3, 0.06)),
              said="ball1 isInside bathtub1"),
    situation("a stool on a rug", thing("rug1", (0.0, 0.0, 0.0)), thing("stool1", (0.0, 0.3, 0.01)),
              said="stool1 isOn rug1"),
    situation("shoes in a rack", thing("shoe_rack1", (0.0, 0.0, 0.0)),
              thing("shoes1", (0.0, 0.0, _in("shoe_rack", 1))), said="shoes1 isOn shoe_rack1"),
    situation("a box under a table with a cup on it", TABLE, thing("box1", (0.0, 0.0, 0.0)), on_table("cup1"),
              said="cup1 isOn table1", also="box1 isUnder table1", never="cup1 isOn box1"),
    situation("a lamp that hangs over a table", TABLE, thing("light1", (0.0, 0.0, 1.6)),
              also="light1 isAbove table1"),
    situation("a picture on a wall", WALL, thing("picture1", (-0.83, 0.0, 1.3)),
              said="picture1 isAttachedTo wall1"),
    situation("a shelf on a wall, with a book", WALL, thing("shelf1", (-0.725, 0.0, 1.2)),
              thing("book1", (-0.725, 0.1, 1.2 + tall("shelf"))),
              said="shelf1 isAttachedTo wall1, book1 isOn shelf1"),
    situation("a cabinet at a wall", WALL, thing("cabinet1", (-0.6, 0.0, 0.0)),
              never="cabinet1 isAttachedTo wall1"),
    situation("a picture on the floor, leaning on a wall", WALL,
              thing("picture1", (-0.7, 0.0, 0.0), turn=about_y(-14.0)),
              also="picture1 isLeaningAgainst wall1", never="picture1 isAttachedTo wall1"),
    situation("side by side", TABLE, on_table("cup1", y=-0.08), on_table("cup2", y=0.1),
              said="cup1 isOn table1, cup2 isOn table1", also="cup1 isNextTo cup2, cup2 isNextTo cup1"),
    situation("the middle one of three", TABLE, *(on_table(f"cup{n}", x=0.15 * (n - 2)) for n in (1, 2, 3)),
              said="cup1 isOn table1, cup2 isOn table1, cup3 isOn table1",
              also="cup1 isNextTo cup2, cup2 isBetween cup1", never="cup1 isNextTo cup3"),
    situation("close by, on another thing", TABLE, on_table("cup1", y=0.55), thing("stool1", (0.0, 0.85,
              0.0)),
              thing("cup2", (0.0, 0.75, tall("stool"))),
              said="cup1 isOn table1, cup2 isOn stool1", never="cup1 isNextTo cup2"),
    situation("touching", TABLE, on_table("box1", y=-0.1, size=BLOCK), on_table("box2", y=0.1, size=BLOCK),
              said="box1 isOn table1, box2 isOn table1", also="box1 touches box2, box1 isNextTo box2"),
    situation("two things in one place", TABLE, on_table("cup1"), on_table("cup2"),
              said="cup1 isOn table1, cup2 isOn table1"),
    situation("in the corner of a room", place("kitchen1", (0.0, 0.0, 0.0), (6.0, 6.0, 2.5)),
              place("corner1", (0.5, 0.5, 0.0), (1.5, 1.5, 2.5)), thing("floor_lamp1", (0.4, 0.4, 0.0)),
              said="floor_lamp1 isLocatedIn corner1", never="floor_lamp1 isLocatedIn kitchen1"),
    situation("where two rooms meet, more in one", place("kitchen1", (-2.0, 0.0, 0.0), (4.0, 4.0, 2.5)),
              place("hall1", (2.0, 0.0, 0.0), (4.0, 4.0, 2.5)), thing("armchair1", (0.15, 0.0, 0.0)),
              said="armchair1 isLocatedIn hall1"),
    situation("through a wall, in the flat only", place("flat1", (0.0, 0.0, 0.0), (9.0, 9.0, 2.5)),
              place("kitchen1", (-2.1, 0.0, 0.0), (4.0, 4.0, 2.5)),
              place("hall1", (2.1, 0.0, 0.0), (4.0, 4.0, 2.5)),
              thing("door1", (0.0, 0.0, 0.0)), said="door1 isLocatedIn flat1"),
    situation("of no known size", place("kitchen1", (0.0, 0.0, 0.0), (4.0, 4.0, 2.5)), TABLE,
              thing("thing1", (0.0, 0.0, TOP)),
              said="thing1 isLocatedIn kitchen1, table1 isLocatedIn kitchen1"),
    situation("a cup on a tray on a couch", COUCH, thing("tray1", (0.1, 0.0, seat("couch"))),
              thing("cup1", (0.1, 0.0, seat("couch") + 0.01)),
              said="tray1 isOn couch1, cup1 isOn tray1", also="cup1 isAbove couch1",
              never="cup1 isUnder couch1"),
    situation("the second book on a chair", CHAIR, thing("book1", (0.03, 0.0, seat("chair"))),
              thing("book2", (0.03, 0.0, seat("chair") + tall("book"))),
              said="book1 isOn chair1, book2 isOn book1", never="book2 isUnder chair1"),
    situation("a ball on an armchair's cushion", thing("armchair1", (0.0, 0.0, 0.0)),
              thing("cushion1", (0.1, 0.0, seat("armchair"))),
              thing("ball1", (0.1, 0.0, seat("armchair") + tall("cushion"))),
              said="cushion1 isOn armchair1, ball1 isOn cushion1", never="ball1 isUnder armchair1"),
    situation("a towel on a pillow on a bed", thing("bed1", (0.0, 0.0, 0.0)),
              thing("pillow1", (-0.6, 0.3, surface("bed", -1))),
              thing("towel1", (-0.6, 0.3, surface("bed", -1) + tall("pillow"))),
              said="pillow1 isOn bed1, towel1 isOn pillow1", never="towel1 isUnder bed1"),
    situation("a chair pushed under a desk", thing("desk1", (0.0, 0.0, 0.0)),
              thing("chair1", (0.42, 0.25, 0.0), yaw=math.pi), also="chair1 isUnder desk1",
              never="chair1 isAbove desk1"),
    situation("a box under a chair", CHAIR, thing("box1", (0.0, 0.0, 0.0), size=BLOCK),
              also="box1 isUnder chair1", never="box1 isAbove chair1"),
    situation("a box behind a chair's backrest", CHAIR, thing("box1", (-0.35, 0.0, 0.0), size=BLOCK),
              never="box1 isUnder chair1"),
    situation("a picture three centimetres above a couch", COUCH,
              thing("picture1", (-0.4, 0.0, tall("couch") + 0.03), fixed=True),
              never="picture1 isOn couch1"),
    situation("a picture on a wall, just above a couch", WALL, thing("couch1", (-0.4, 0.0, 0.0)),
              thing("picture1", (-0.83, 0.0, tall("couch")), fixed=True), said="picture1 isAttachedTo wall1"),
    situation("a ceiling light just above a wardrobe", ROOM, thing("wardrobe1", (0.0, 0.0, 0.0)),
              thing("light1", (0.0, 0.0, tall("wardrobe")), fixed=True),
              said="wardrobe1 isLocatedIn room1, light1 isLocatedIn room1", never="light1 isOn wardrobe1"),
    situation("a hook with a jacket", ROOM, thing("jacket1", (0.0, 0.0, 0.8), size=(0.1, 0.5, 0.9)),
              thing("jacket_hook1", (0.0, 0.0, 1.7), fixed=True),
              said="jacket1 isLocatedIn room1, jacket_hook1 isLocatedIn room1",
              never="jacket_hook1 isOn jacket1"),
    situation("a tap on a counter", thing("counter1", (0.0, 0.0, 0.0)),
              thing("tap1", (0.0, 0.0, tall("counter")), fixed=True), said="tap1 isOn counter1"),
    situation("a sink let into a counter, with a potato", thing("counter1", (0.0, 0.0, 0.0)),
              thing("sink1", (0.0, 0.0, tall("counter") - 0.437), size=(0.45, 0.5, 0.5), fixed=True),
              thing("potato1", (0.0, 0.0, tall("counter") - 0.08)),
              said="sink1 isInside counter1, potato1 isInside sink1", never="sink1 isAttachedTo counter1"),
    situation("a sink on a table", TABLE, on_table("sink1", size=(0.45, 0.5, 0.2), fixed=True),
              said="sink1 isOn table1", never="sink1 isInside table1"),
    situation("an umbrella in a bucket", BUCKET,
              thing("umbrella1", (0.05, 0.0, 0.46), turn=about_y(-90.0)), said="umbrella1 isInside bucket1"),
    situation("a broom with its stick in a bucket", BUCKET,
              thing("broom1", (0.0, 0.0, 1.37), turn=about_y(180.0)), said="broom1 isInside bucket1"),
    situation("a baguette in a basket", TABLE, on_table("basket1"),
              on_table("baguette1", x=0.05, z=0.012, size=(0.07, 0.07, 0.65)),
              said="basket1 isOn table1, baguette1 isInside basket1"),
    situation("a stick that leans in a bucket", BUCKET,
              thing("stick1", (-0.05, 0.0, 0.0135), size=(0.02, 0.02, 1.0), turn=about_y(20.0)),
              said="stick1 isInside bucket1"),
    situation("a stick in a bin", thing("bin1", (0.0, 0.0, 0.0)),
              thing("stick1", (0.0, 0.05, 0.02), size=(0.08, 0.08, 0.9)), said="stick1 isInside bin1"),
    situation("a stick beside a bucket", BUCKET, thing("stick1", (0.2, 0.0, 0.0), size=(0.02, 0.02, 1.0))),
    situation("a bottle on a tray is not inside it", TABLE, on_table("tray1"), on_table("bottle1", z=0.01),
              said="tray1 isOn table1, bottle1 isOn tray1"),
    situation("a potato in a pot", TABLE, on_table("pot1"), on_table("potato1", z=0.006),
              said="pot1 isOn table1, potato1 isInside pot1", never="potato1 isOn pot1"),
    situation("a ladle in a pot", TABLE, on_table("pot1"),
              on_table("ladle1", x=0.05, z=0.01, size=(0.03, 0.03, 0.3)),
              said="pot1 isOn table1, ladle1 isInside pot1"),
    situation("a plate on a pot", TABLE, on_table("pot1"), on_table("plate1", z=surface("pot")),
              said="pot1 isOn table1, plate1 isOn pot1", never="plate1 isInside pot1"),
    situation("a potato beside a pot", TABLE, on_table("pot1"), on_table("potato1", y=0.2),
              said="pot1 isOn table1, potato1 isOn table1", never="potato1 isInside pot1"),
    situation("an egg in a kettle", TABLE, on_table("kettle1"), on_table("egg1", z=0.025),
              said="kettle1 isOn table1, egg1 isInside kettle1"),
    situation("a tea bag in a teapot", TABLE, on_table("teapot1"),
              on_table("tea_bag1", z=0.02, size=(0.04, 0.05, 0.01)),
              said="teapot1 isOn table1, tea_bag1 isInside teapot1"),
    situation("a spoon that looks out of a pitcher", TABLE, on_table("pitcher1"),
              on_table("spoon1", x=-0.007, z=0.15, turn=about_y(90.0), size=(0.28, 0.042, 0.014)),
              said="pitcher1 isOn table1, spoon1 isInside pitcher1"),
    situation("a flower in a vase", TABLE, on_table("vase1"),
              on_table("rose1", z=0.005, size=(0.03, 0.03, 0.5)),
              said="vase1 isOn table1, rose1 isInside vase1"),
    situation("an olive in a jar", TABLE, on_table("jar1"), on_table("olive1", z=0.01, size=(0.02,) * 3),
              said="jar1 isOn table1, olive1 isInside jar1"),
    situation("a message in a bottle", TABLE, on_table("bottle1"),
              on_table("message1", z=0.01, size=(0.02, 0.02, 0.1)),
              said="bottle1 isOn table1, message1 isInside bottle1"),
    situation("a bead in a can", TABLE, on_table("can1"), on_table("bead1", z=0.01, size=(0.02,) * 3),
              said="can1 isOn table1, bead1 isInside can1"),
    situation("a sweet in a carton", TABLE, on_table("carton1"),
              on_table("sweet1", x=0.01, z=0.01, size=(0.02, 0.02, 0.015)),
              said="carton1 isOn table1, sweet1 isInside carton1"),
    situation("a glass at the place of a carton", TABLE, on_table("carton1"), on_table("glass1"),
              said="carton1 isOn table1, glass1 isOn table1", never="glass1 isInside carton1"),
    situation("a straw that overlaps a carton", TABLE, on_table("carton1"),
              on_table("straw1", z=0.01, size=(0.006, 0.006, 0.25)),
              said="carton1 isOn table1, straw1 isOn table1", never="straw1 isInside carton1"),
    situation("a knife that overlaps a bottle", TABLE, on_table("bottle1"),
              on_table("knife1", x=0.03, z=0.02, size=(0.18, 0.02, 0.01)),
              said="bottle1 isOn table1, knife1 isOn table1", never="knife1 isInside bottle1"),
    situation("an egg at the place of a can", TABLE, on_table("can1"), on_table("egg1"),
              said="can1 isOn table1, egg1 isOn table1", never="egg1 isInside can1"),
    situation("a bead beside a can, within its bounds", TABLE, on_table("can1"),
              on_table("bead1", x=0.026, y=0.026, z=0.005, size=(0.005,) * 3),
              said="can1 isOn table1, bead1 isOn table1", never="bead1 isInside can1"),
    situation("a spoon at the place of a spray bottle", TABLE, on_table("spray_bottle1"),
              on_table("spoon1", y=0.02), said="spray_bottle1 isOn table1, spoon1 isOn table1",
              never="spoon1 isInside spray_bottle1"),
    situation("a plate that is wider than the bowl below it", TABLE, BOWL,
              on_table("plate1", z=0.03), said="bowl1 isOn table1, plate1 isOn bowl1",
              never="plate1 isInside bowl1"),
    situation("a baguette in a bag", thing("bag1", (0.0, 0.0, 0.0)),
              thing("baguette1", (0.0, 0.05, 0.01), size=(0.07, 0.07, 0.65)), said="baguette1 isInside bag1"),
    situation("a book in a backpack", thing("backpack1", (0.0, 0.0, 0.0)),
              thing("book1", (-0.014, 0.0, 0.01), size=(0.03, 0.2, 0.25)), said="book1 isInside backpack1"),
    situation("papers in a case", TABLE, on_table("case1"),
              on_table("papers1", z=0.01, size=(0.02, 0.3, 0.2)),
              said="case1 isOn table1, papers1 isInside case1"),
    situation("a trowel in a flower pot", TABLE, on_table("flower_pot1"),
              on_table("trowel1", x=0.03, z=0.05, size=(0.02, 0.04, 0.3)),
              said="flower_pot1 isOn table1, trowel1 isInside flower_pot1"),
    situation("a brush in a toilet", thing("toilet1", (0.0, 0.0, 0.0)),
              thing("brush1", (0.05, 0.0, 0.2), size=(0.07, 0.07, 0.4)), said="brush1 isInside toilet1"),
    situation("a roll on the cistern of a toilet", thing("toilet1", (0.0, 0.0, 0.0)),
              thing("toilet_paper1", (-0.25, 0.0, surface("toilet"))), said="toilet_paper1 isOn toilet1",
              never="toilet_paper1 isInside toilet1"),
    situation("nine kilometres away", thing("table1", (9000.0, 0.0, 0.0)), thing("cup1", (9000.0, 0.0, TOP)),
              said="cup1 isOn table1"),
)  # fmt: skip

Relate = Callable[[tuple[Entity, ...]], set[Said]]
