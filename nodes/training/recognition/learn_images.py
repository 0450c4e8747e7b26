"""Learn what images say about classes: `python -m semmap.nodes.training.recognition.learn_images`.

The images are renderings of third-party objects with their textures, changed in many ways so that they
resemble photographs. Each object is a look of its own.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter
from scipy import ndimage
from scipy.optimize import minimize

from semmap.nodes.perception_node.image_features.crops import crops_of
from semmap.nodes.perception_node.image_features.efficientnet import CLASSES, FEATURES
from semmap.nodes.perception_node.image_features.image_classifier import (
    SHIPPED,
    ImageClassifier,
    classifier_input,
    save,
)
from semmap.nodes.perception_node.image_features.image_evidence import Network
from semmap.nodes.perception_node.image_features.network import load_network
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.training.recognition.imagenet_classes import classes_by_number
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.nodes.training.scenes.textured_scenes import Studio, scenes

_FEWEST = 150
_DISTANCE_M = (0.5, 1.6)
_LONGEST = (35, 160)
"""The longer side of things in images of other cameras [pixel]."""
_DECAY, _SCALE, _STEPS = 3e-4, 20.0, 30

_LOOK_ALIKE = {
    "Box": {"Box": 1.0, "Carton": 1.0, "Cereals": 0.5}
    | {"Book": 0.3, "Drug": 0.5, "Magazine": 0.3, "Folder": 0.3},
    "Cup": {"Cup": 1.0, "Glass": 1.0, "Bowl": 0.7, "Pot": 0.7, "Flower_Pot": 0.3, "Yogurt": 0.3},
    "Plate": {"Plate": 1.0, "Bowl": 0.5},
    "Bottle": {"Bottle": 1.0, "Cleaner": 1.0, "Wine": 1.0},
    "Can": {"Can": 1.0, "Jar": 0.5},
    "Pitcher": {"Pitcher": 1.0, "Kettle": 0.5, "Pot": 0.2},
}
"""Classes that images confuse with one that was learnt, and how far; shape tells them apart."""

_PLAIN_BLOCKS = ("ycb 036_wood_block", "ycb 061_foam_brick")
"""Things of no class that look like boxes."""


class Picture(NamedTuple):
    """The image of one thing (H, W, 3), its pixels (H, W), and its look: the name of a foreign thing."""

    look: str
    colours: NDArray[np.uint8]
    own: NDArray[np.bool_]


def pictures_of_foreign(
    things: Sequence[ForeignThing], tables: int, rng: np.random.Generator
) -> Iterator[Picture]:
    """Yield renderings of things, eight on a table."""
    studio = Studio()
    for _, stood in scenes(things, 0, tables, rng):
        _, rgb, _, owner = studio.shoot(stood, float(rng.uniform(*_DISTANCE_M)), rng)
        for number, one in enumerate(stood, 1):
            yield from _picture(one.thing.name, rgb, owner == number)


def _picture(look: str, colours: NDArray[np.uint8], own: NDArray[np.bool_]) -> Iterator[Picture]:
    """Yield a thing with its surroundings, if enough of it is visible."""
    if np.count_nonzero(own) < _FEWEST:
        return
    rows, columns = (np.flatnonzero(own.any(axis=axis)) for axis in (1, 0))
    room = int(0.3 * max(np.ptp(rows), np.ptp(columns))) + 4
    part = np.s_[
        max(0, rows[0] - room) : rows[-1] + room + 1, max(0, columns[0] - room) : columns[-1] + room + 1
    ]
    yield Picture(look, colours[part].copy(), own[part].copy())


def varied(picture: Picture, rng: np.random.Generator) -> Picture:
    """Return a picture with other light, colours, sharpness, size and background, and inexact pixels."""
    values, own = picture.colours.astype(np.float32), picture.own
    if rng.random() < 0.35:
        background = rng.uniform(20, 235, 3) + rng.normal(0, 12, values.shape)
        values = np.where(own[..., None], values, background)
    values = 255 * np.clip(values / 255, 0, 1) ** np.exp(rng.normal(0, 0.25))
    values = values * np.exp(rng.normal(0, 0.2)) * np.exp(rng.normal(0, 0.06, 3)) + rng.normal(0, 8)
    values = values + rng.normal(0, rng.uniform(0, 6), values.shape)
    rows, columns = (np.flatnonzero(own.any(axis=axis)) for axis in (1, 0))
    longest = max(np.ptp(rows), np.ptp(columns)) + 1
    share = min(1.0, float(np.exp(rng.uniform(*np.log(_LONGEST)))) / longest)
    size = max(8, int(own.shape[1] * share)), max(8, int(own.shape[0] * share))
    image = Image.fromarray(np.clip(values, 0, 255).astype(np.uint8)).resize(size, Image.Resampling.BOX)
    if rng.random() < 0.4:
        image = image.filter(ImageFilter.GaussianBlur(float(rng.uniform(0.3, 1.2))))
    mask = Image.fromarray(np.where(own, 255, 0).astype(np.uint8)).resize(size, Image.Resampling.BOX)
    own, colours = np.asarray(mask) > 127, np.asarray(image)
    if rng.random() < 0.5 and np.count_nonzero(own) > 2 * _FEWEST:
        own = ndimage.binary_erosion(own) if rng.random() < 0.6 else ndimage.binary_dilation(own)
    if rng.random() < 0.5:
        colours, own = colours[:, ::-1], own[:, ::-1]
    return Picture(picture.look, colours, own)


def inputs_of(pictures: Sequence[Picture], network: Network) -> Numbers:
    """Return the inputs (N, 2 FEATURES) of the classifier; pictures without pixels of a thing are invalid."""
    crops = [crops_of([(one.colours, one.own.astype(np.int32))], 1) for one in pictures]
    if any(pair is None for pair in crops):
        raise ValueError("a picture shows nothing of its thing")
    whole, alone = (network([pair[part] for pair in crops if pair is not None]) for part in (0, 1))
    return classifier_input(whole, alone)


def learn(inputs: Numbers, looks: Sequence[str], things: Sequence[ForeignThing]) -> ImageClassifier:
    """Train the classifier of looks (N,) on inputs (N, 2 FEATURES)."""
    names = sorted(set(looks))
    target = np.array([names.index(look) for look in looks])
    weight = np.bincount(target)[target] ** -0.7
    weights, biases = _logistic(inputs, target, weight / weight.sum(), len(names))
    like = {thing.name: _classes_like(thing) for thing in things}
    named, imagenet = [like[name] for name in names], classes_by_number()
    leaves = sorted({class_ for classes in (*named, *imagenet.values()) for class_ in classes})
    table, known = np.zeros((len(names), len(leaves))), np.zeros((CLASSES, len(leaves)))
    for row, classes in enumerate(named):
        for class_, share in classes.items():
            table[row, leaves.index(class_)] = share
    for number, ours in imagenet.items():
        known[number, [leaves.index(class_) for class_ in ours]] = 1.0
    story = f"{len(looks)} images of {len(names)} foreign things"
    centre = inputs[:, FEATURES:].mean(axis=0)
    return ImageClassifier(tuple(leaves), weights, biases, table, known, centre, story)


def _classes_like(thing: ForeignThing) -> dict[str, float]:
    if thing.new:
        return {UNKNOWN: 1.0} | ({"Box": 0.5} if thing.name in _PLAIN_BLOCKS else {})
    first = thing.classes[0]
    return _LOOK_ALIKE.get(first, {first: 1.0})


def _logistic(
    inputs: Numbers, target: NDArray[np.int64], weight: Numbers, count: int
) -> tuple[Numbers, Numbers]:
    """Return weights (D, count) and biases (count,) of a logistic regression, which decays."""
    scaled, truth = np.asarray(_SCALE * inputs, np.float32), np.eye(count)[target]
    width = scaled.shape[1]

    def loss(values: Numbers) -> tuple[float, Numbers]:
        table = values.reshape(count, width + 1)
        scores = scaled @ table[:, :-1].T.astype(np.float32) + table[:, -1]
        scores = scores - scores.max(axis=1, keepdims=True)
        logs = scores - np.log(np.exp(scores).sum(axis=1, keepdims=True))
        slope = weight[:, None] * (np.exp(logs) - truth)
        by_table = np.column_stack([slope.T.astype(np.float32) @ scaled, slope.sum(axis=0)])
        by_table[:, :-1] += 2.0 * _DECAY * table[:, :-1]
        cost = -(weight[:, None] * truth * logs).sum() + _DECAY * (table[:, :-1] ** 2).sum()
        return float(cost), by_table.ravel()

    start = np.zeros(count * (width + 1))
    table = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": _STEPS}).x
    table = table.reshape(count, width + 1)
    return _SCALE * table[:, :-1].T, table[:, -1]


def main() -> None:
    """Render, train, and write the shipped classifier."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("foreign", type=Path, help="a folder of foreign things")
    parser.add_argument("--tables", type=int, default=110, help="tables of eight foreign things")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    rng, network = np.random.default_rng(options.seed), load_network()
    things = [thing for thing in foreign_things(options.foreign) if thing.learnable]
    changed = [varied(picture, rng) for picture in pictures_of_foreign(things, options.tables, rng)]
    changed = [picture for picture in changed if picture.own.any()]
    learnt = learn(inputs_of(changed, network), [picture.look for picture in changed], things)
    save(learnt, options.out)
    print(f"{options.out}: {learnt.story}")


if __name__ == "__main__":
    main()
