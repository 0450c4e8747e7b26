"""Synthetic plans: two rooms and a corridor, 0.1 m walls, doors 0.9 m wide."""

from semmap.schemas.plans import Outline, Plan, PlannedPlace, PlannedThing


def box(x0, y0, x1, y1, low=0.0, high=2.5):
    return Outline(corners=((x0, y0), (x1, y0), (x1, y1), (x0, y1)), low=low, high=high)


def place(name, x0, y0, x1, y1, **more):
    corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return PlannedPlace(name=name, label=name, class_="Room", rings=(corners,), floor=0.0, height=2.5, **more)


def thing(name, *parts, **more):
    (x0, y0), (x1, y1) = (
        tuple(pick(c[k] for p in parts for c in p.corners) for k in (0, 1)) for pick in (min, max)
    )
    footprint = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return PlannedThing(name=name, label=name, class_="Thing", parts=parts, footprint=footprint, **more)


def door(name, x0, y0, x1, y1, **more):
    return thing(name, box(x0, y0, x1, y1, high=2.08), door=True, **more)


WALLS = (
    box(-0.1, -0.1, 8.1, 0.0),
    box(-0.1, 5.0, 8.1, 5.1),
    box(-0.1, 0.0, 0.0, 5.0),
    box(8.0, 0.0, 8.1, 5.0),
    box(4.0, 0.0, 4.1, 1.0),
    box(4.0, 1.9, 4.1, 5.0),
    box(4.0, 1.0, 4.1, 1.9, low=2.1),
)
"""Two rooms, west and east, with a doorway at y 1 to 1.9."""
PLACES = (place("west", 0.0, 0.0, 4.0, 5.0), place("east", 4.1, 0.0, 8.0, 5.0))
DOOR = door("door1", 4.02, 1.01, 4.08, 1.89)


def plan(*things, places=PLACES, walls=WALLS):
    return Plan(places=places, things=things, walls=walls)
