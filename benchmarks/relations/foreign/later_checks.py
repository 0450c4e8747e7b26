"""Worlds drawn after the errors of the others had been mended; they showed one more (the tent)."""

from __future__ import annotations

import math
import re

from benchmarks.relations.foreign.common import BOOK, BOWL, MUG, PLATE
from benchmarks.relations.foreign.drawing import (
    Body,
    ForeignWorld,
    Part,
    ball,
    bar,
    box,
    crate,
    fixed,
    free,
    hull,
    sliding,
    sum_of,
    table,
    tube,
    vessel,
)


def _turn(part: Part, degrees: float) -> Part:
    """Return boxes turned about the origin of their body."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def turned(found: re.Match[str]) -> str:
        x, y, z = map(float, found[1].split())
        return f'pos="{c * x - s * y:.5g} {s * x + c * y:.5g} {z:.5g}" euler="0 0 {degrees}"'

    return Part(re.sub(r'pos="([^"]*)"', turned, part.geoms))


def rotated_in_body() -> ForeignWorld:
    """Furniture turned inside its body's frame, as exporters write whose bodies have no rotation."""
    box_x = _turn(crate((0.4, 0.3, 0.2), wall=0.01), 35)
    return ForeignWorld(
        "rotated_in_body",
        (
            fixed("bench_x", (0, 0, 0), _turn(table(1.2, 0.6, 0.5), 35)),
            free("box_x", (0, 0, 0.5), box_x + Part("", (((0.28, 0.28, 0.19), (0, 0, 0.01), True),))),
            free("ball_in", (0.02, 0, 0.51), ball(0.05)),
            free("mug_beside", (0.24, -0.08, 0.5), MUG),
            free("shoe", (0.1, 0.1, 0), box((0.25, 0.1, 0.1)), yaw=35),
            free("far_shoe", (0.55, -0.42, 0), box((0.2, 0.08, 0.08))),
        ),
    )


def stacks() -> ForeignWorld:
    """Bowls in bowls, covered pots, and a tower of boxes."""
    big = vessel(0.12, 0.09, 0.006, foot=0.07, staves=18)
    mid = vessel(0.09, 0.07, 0.006, foot=0.055, staves=18)
    return ForeignWorld(
        "stacks",
        (
            fixed("counter_z", (0, 0, 0), box((1.6, 0.6, 0.9))),
            free("bowl_big", (-0.5, 0, 0.9), big),
            free("bowl_mid", (-0.5, 0, 0.907), mid),
            free("egg_x", (-0.5, 0, 0.915), ball(0.022)),
            free("stew_pot", (0, 0, 0.9), vessel(0.11, 0.15, 0.006)),
            free("stew_lid", (0, 0, 1.051), tube(0.115, 0.01) + tube(0.012, 0.03, (0, 0, 0.01))),
            free("carrot", (0, 0, 0.907), ball(0.03)),
            free("salad", (0.4, 0, 0.9), BOWL),
            free("cover_plate", (0.4, 0, 0.956), PLATE),
            free("cherry", (0.4, 0, 0.907), ball(0.012)),
            free("box_a", (0.65, 0.1, 0.9), box((0.2, 0.2, 0.1))),
            free("box_b", (0.68, 0.1, 1.001), box((0.2, 0.2, 0.1)), yaw=20),
            free("box_c", (0.66, 0.12, 1.102), box((0.15, 0.15, 0.1)), yaw=50),
        ),
    )


def tipped() -> ForeignWorld:
    """A crate on its side, and things that lean in a tub."""
    cr = crate((0.4, 0.3, 0.3), wall=0.01)
    return ForeignWorld(
        "tipped",
        (
            Body("crate_tipped", (0, 0, 0.2), cr, tilt=90, joint="<freejoint/>"),
            free("ball_tipped", (0.15, 0, 0.02), ball(0.05)),
            free("box_on_tipped", (0.15, 0, 0.41), box((0.1, 0.1, 0.1))),
            free("plank", (1.0, 0, 0), box((0.8, 0.2, 0.03))),
            free("tub", (1.0, 0.5, 0), vessel(0.2, 0.3, 0.01, staves=20)),
            free("bat", (1.0, 0.5, 0.012), bar(0.02, (0, 0, 0.02), (0, 0, 0.7))),
            free("racket", (1.1, 0.5, 0.012), bar(0.015, (0, 0, 0.015), (0, 0, 0.5))),
        ),
    )


def racks() -> ForeignWorld:
    """A drawer with an organizer in it, a dish rack, an aquarium, and things below them."""
    plates = (
        box((0.4, 0.2, 0.01))
        + sum_of(bar(0.004, (x / 50, -0.08, 0.01), (x / 50, -0.08, 0.1)) for x in range(-8, 9, 2))
        + sum_of(bar(0.004, (x / 50, 0.08, 0.01), (x / 50, 0.08, 0.1)) for x in range(-8, 9, 2))
    )
    tree = (
        tube(0.08, 0.02)
        + tube(0.012, 0.35, (0, 0, 0.02))
        + sum_of(
            bar(0.006, (0.01 * c, 0.01 * s, 0.3), (0.07 * c, 0.07 * s, 0.33))
            for c, s in ((1, 0), (-1, 0), (0, 1), (0, -1))
        )
    )
    rail = (
        box((0.7, 0.02, 0.05), (0, 0.1, 0))
        + bar(0.01, (-0.3, 0, 0.02), (0.3, 0, 0.02))
        + bar(0.01, (-0.3, 0, 0.02), (-0.3, 0.1, 0.02))
        + bar(0.01, (0.3, 0, 0.02), (0.3, 0.1, 0.02))
    )
    org = crate((0.3, 0.2, 0.06), wall=0.005)
    drawer = crate((0.5, 0.4, 0.12), wall=0.01, floor=0.004) + box((0.54, 0.015, 0.14), (0, -0.21, 0))
    cab = sum_of(
        (
            box((0.01, 0.44, 0.5), (-0.27, 0, 0)),
            box((0.01, 0.44, 0.5), (0.27, 0, 0)),
            box((0.55, 0.01, 0.5), (0, 0.22, 0)),
            box((0.55, 0.45, 0.02), (0, 0, 0.5)),
            box((0.55, 0.44, 0.01)),
        )
    )
    return ForeignWorld(
        "racks",
        (
            fixed(
                "kitchen_unit",
                (0, 0, 0),
                cab,
                sliding("kitchen_unit_drawer_a", (0, 0, 0.3), drawer, "ku_a", "0 -1 0", 0.35),
                sliding("kitchen_unit_drawer_b", (0, 0, 0.05), drawer, "ku_b", "0 -1 0", 0.35),
            ),
            free("organizer", (0, 0, 0.305), org),
            free("spoon_x", (0, 0, 0.311), box((0.03, 0.15, 0.01))),
            free("tape", (-0.2, 0, 0.305), tube(0.03, 0.02)),
            free("bag_rice", (0, 0, 0.055), box((0.2, 0.15, 0.08))),
            free("dish_rack", (0, 0.05, 0.52), plates),
            free("dish_lying", (0, 0.05, 0.531), box((0.1, 0.1, 0.01))),
            free("spice_jar", (0.22, -0.1, 0.52), vessel(0.025, 0.06, 0.003)),
            free("clove", (0.22, -0.1, 0.524), box((0.006, 0.006, 0.006))),
            fixed("mug_tree", (1, 0, 0), tree),
            free("coaster_x", (1.0, 0.12, 0), tube(0.04, 0.006)),
            fixed("towel_rail", (2, 0.4, 1.0), rail),
            fixed("aquarium_stand", (-1.2, 0, 0), table(0.8, 0.4, 0.7)),
            free("aquarium", (-1.2, 0, 0.7), crate((0.6, 0.3, 0.35), wall=0.006)),
            free("stone", (-1.2, 0, 0.707), box((0.1, 0.1, 0.06))),
            free("castle", (-1.2, 0, 0.768), box((0.08, 0.08, 0.1))),
            free("bucket_under", (-1.2, 0, 0), vessel(0.13, 0.25, 0.006, foot=0.1)),
            free("sponge_u", (-1.2, 0, 0.007), box((0.1, 0.06, 0.04))),
        ),
        open={"ku_a": 0.3},
    )


def attic() -> ForeignWorld:
    """A sloping roof, a tent, a ladder and a hammock, with things below them."""
    roof = Part('<geom type="box" size="1.5 1.0 .02" pos="0 -0.75 2.0" euler="35 0 0"/>')
    bed = box((0.9, 1.9, 0.3), (0, 0, 0))
    tent = Part(
        '<geom type="box" size=".7 .45 .01" pos="0 -.3 .4" euler="55 0 0"/>'
        '<geom type="box" size=".7 .45 .01" pos="0 .3 .4" euler="-55 0 0"/>'
    )
    return ForeignWorld(
        "attic",
        (
            fixed("roof_slope", (0, 0, 0), roof),
            free("low_bed", (0, -0.5, 0), bed),
            free("night_lamp", (0.7, 0.4, 0), tube(0.08, 0.3)),
            fixed("tent_play", (3, 0, 0), tent),
            free("toy_in_tent", (3, 0, 0), ball(0.08)),
            free("book_out", (3, 0.9, 0), BOOK),
            fixed(
                "ladder_loft",
                (5, 0, 0),
                sum_of(box((0.5, 0.03, 0.03), (0, 0.1 * k, 0.25 * k + 0.2)) for k in range(7))
                + bar(0.02, (-0.25, -0.06, 0), (-0.25, 0.75, 2.0))
                + bar(0.02, (0.25, -0.06, 0), (0.25, 0.75, 2.0)),
            ),
            free("cat_toy_l", (5, 0.6, 0), ball(0.05)),
            free("paint_l", (5, 0.3, 0), tube(0.08, 0.15)),
            fixed(
                "hammock",
                (7, 0, 0),
                hull(
                    "hammock_hull",
                    [(x, y, 0.6 + 0.3 * abs(x)) for x in (-1, -0.5, 0, 0.5, 1) for y in (-0.4, 0.4)],
                ),
            ),
            free("ball_under_h", (7, 0, 0), ball(0.1)),
        ),
    )


WORLDS = (rotated_in_body, stacks, tipped, racks, attic)
