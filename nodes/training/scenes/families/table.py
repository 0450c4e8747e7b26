"""All families, and drawing one of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from semmap.nodes.sim_node.models.model_files import keyed
from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.containers import (
    bottle,
    drink_can,
    flower_pot,
    food_can,
    jar,
    vase,
    wine_bottle,
)
from semmap.nodes.training.scenes.families.cookware import pan, pot, teapot
from semmap.nodes.training.scenes.families.produce import (
    apple,
    lemon,
    onion,
    orange,
    other_fruit,
    pear,
    potato,
)
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.families.tableware import bowl, cup, glass, pitcher, plate, stem_glass
from semmap.nodes.training.scenes.families.utensils import ladle, screwdriver, spatula, sponge
from semmap.nodes.training.scenes.simulated_scenes import foreign_label

Draw = Callable[[RandomValues, Colour], Parts]


class Family(NamedTuple):
    """`kind`: the model whose class they have; of a class without a model, see `foreign_label`."""

    kind: str
    draw: Draw


def drawn(family: Family, colour: Colour, rng: np.random.Generator) -> Parts:
    """Return a sample of a family on the ground, in this colour and matching ones."""
    return keyed(family.draw(RandomValues(rng), colour), f"{family.kind} {rng.integers(1 << 62)}")


FAMILIES: tuple[Family, ...] = (
    *(Family("bottle", bottle),) * 2,
    Family("wine_bottle", wine_bottle),
    Family("jar", jar),
    Family("can", drink_can),
    Family("can", food_can),
    *(Family("cup", cup),) * 2,
    Family("glass", glass),
    Family("glass", stem_glass),
    Family("bowl", bowl),
    Family("plate", plate),
    *(Family("pitcher", pitcher),) * 2,
    Family("pot", pot),
    *(Family("kettle", teapot),) * 2,
    Family("pan", pan),
    Family("vase", vase),
    Family("flower_pot", flower_pot),
    *(Family("apple", apple),) * 2,
    *(Family("pear", pear),) * 2,
    Family("orange", orange),
    Family("lemon", lemon),
    Family("potato", potato),
    Family("onion", onion),
    Family(foreign_label("fruit", "Fruit", new=False), other_fruit),
    Family(foreign_label("spatula", "Utensil", new=False), spatula),
    Family(foreign_label("ladle", "Utensil", new=False), ladle),
    Family("screwdriver", screwdriver),
    Family(foreign_label("sponge", "Cleaner", new=False), sponge),
)
"""The families with the largest variation are listed twice."""
