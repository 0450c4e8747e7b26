"""A contact sheet of third-party objects with their predicted classes.

    python -m benchmarks.perception.foreign_picture OUT.png [--things DIR] [--samples DIR] [--seed 1]

Every thing whose scan may be published is on one of the tables once, without selection. With the samples
that `semmap.nodes.training.recognition --parts` leaves, perception is trained again without these things.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy import ndimage

from benchmarks.perception.foreign import matched, outcome
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.pipeline import RecognitionModel, observe_views
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN, shipped
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.recognition.__main__ import learn
from semmap.nodes.training.recognition.gathering import read
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.nodes.training.scenes.placements import spread
from semmap.nodes.training.scenes.textured_scenes import Stood, Studio

Picture = NDArray[np.uint8]
Box = tuple[float, float, float, float]
"""First column and row in an image, and last [pixel]."""

ACROSS, TABLES = 3, 6
_PANEL = (500, 375)
_AROUND = 28
"""The margin around the things [pixel]."""
_TABLE_M, _APART_M, _MORE = (0.5, 0.62), 0.05, 1.15
_NEAR_M = 1.0
_PALE, _PAPER = 0.75, 238
_BESIDE = 12
_COLOURS = {
    "exact": (60, 190, 90),
    "above": (240, 180, 40),
    UNKNOWN: (150, 150, 160),
    "wrong": (230, 60, 60),
    "missed": (230, 60, 230),
}
_LEGEND = {
    "exact": "right",
    "above": "a more general class, rightly",
    UNKNOWN: "of a known class, but only Object",
    "wrong": "wrong",
    "missed": "not found",
}


def tables(things: Sequence[ForeignThing], rng: np.random.Generator) -> list[list[Stood]]:
    """Distribute the things over the tables, large ones evenly."""
    largest_first = sorted(things, key=lambda thing: -max(thing.size_m[:2]))
    return [_placed(largest_first[n::TABLES], rng) for n in range(min(TABLES, len(things)))]


def _placed(things: Sequence[ForeignThing], rng: np.random.Generator) -> list[Stood]:
    """Place all things on one table, as densely as necessary."""
    (x, y), z = _TABLE_M, float(rng.uniform(0.5, 0.9))
    while True:
        found = spread([thing.size_m for thing in things], (x, y), _APART_M, rng)
        free = [place for place in found if place is not None]
        if len(free) == len(things):
            return [Stood(t, p[0], p[1], z, p[4]) for t, p in zip(things, free, strict=True)]
        x, y = x * _MORE, y * _MORE


def panel(
    studio: Studio, stood: Sequence[Stood], learnt: RecognitionModel, rng: np.random.Generator
) -> tuple[Image.Image, Counter[str]]:
    """Render a table with the predicted class on each thing, in the colour of the outcome."""
    view, rgb, depth, mask = studio.shoot(stood, _NEAR_M, rng)
    found = observe_views(
        [segment_cloud(cloud_of(depth, rgb, view.intrinsics, view.map_from_camera))], learnt
    )
    labels, classes = found.labels[0], [seen.class_ for seen in found.observations.observations]
    of = matched(np.where(depth > 0, mask, 0), np.where(depth > 0, labels, 0), len(stood), len(classes))
    outcomes = Counter[str]()
    picture, written = (_PALE * _PAPER + (1.0 - _PALE) * rgb).astype(np.uint8), []
    for n, one in enumerate(stood):
        object_ = of[n]
        pixels = mask == n + 1 if object_ is None else labels == object_ + 1
        if not pixels.any():
            continue  # it is hidden behind another
        said = None if object_ is None else classes[object_]
        fits = (*one.thing.classes, UNKNOWN) if one.thing.new else one.thing.classes
        came = outcome(said, fits, learnt)
        outcomes[came] += 1
        shown = pixels | (mask == n + 1)
        picture[shown] = rgb[shown]
        picture[_rim(pixels)] = _COLOURS[came]
        written.append((pixels, _words(said, came, one.thing), came))
    corner, side = _crop(mask > 0)
    image = Image.fromarray(picture).resize(_PANEL, Image.Resampling.LANCZOS, (*corner, *(corner + side)))
    around = [_box_in(pixels, corner, _PANEL[0] / side[0]) for pixels, _, _ in written]
    taken: list[Box] = []
    for box, (_, words, came) in sorted(zip(around, written, strict=True), key=lambda one: one[0][3]):
        taken.append(_write(image, box, words, came, [*around, *4 * taken]))
    return image, outcomes


def _words(said: str | None, came: str, thing: ForeignThing) -> str:
    true = (UNKNOWN if thing.new else thing.classes[0]).replace("_", " ")
    if said is None:
        return f"({true})"
    name = said.replace("_", " ")
    return name if came == "exact" else f"{name} ({true})"


def _rim(pixels: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the box of pixels (H, W), ignoring specks from depth noise."""
    whole = ndimage.binary_fill_holes(ndimage.binary_closing(pixels, iterations=2)) | pixels
    return np.asarray(ndimage.binary_dilation(whole, iterations=3) & ~whole)


def _crop(things: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return corner and size [pixel] of the image part with all things, in a panel's aspect ratio."""
    rows, columns = np.nonzero(things)
    whole = np.array(things.shape[::-1], float)
    low, high = np.array([columns.min(), rows.min()]), np.array([columns.max(), rows.max()])
    wanted = ((high - low + 2 * _AROUND) / _PANEL).max()
    side = np.array(_PANEL) * min(wanted, (whole / _PANEL).min())
    return np.clip((low + high - side) / 2.0, 0.0, whole - side), side


def _box_in(pixels: NDArray[np.bool_], corner: NDArray[np.float64], scale: float) -> Box:
    """Return the box of a thing's pixels (H, W) in a panel."""
    rows, columns = np.nonzero(pixels)
    ends = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]])
    (left, top), (right, bottom) = ((ends - corner) * scale).tolist()
    return left, top, right, bottom


def _write(image: Image.Image, of: Box, words: str, came: str, taken: Sequence[Box]) -> Box:
    """Draw a label at the side of a thing where it covers least; return its box."""
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(18)
    left, top, right, bottom = of
    middle, half = (left + right) / 2.0, draw.textlength(words, font) / 2.0 + 6.0
    sides = [
        *((x, y) for y in (bottom + _BESIDE, top - _BESIDE) for x in (middle, left + half, right - half)),
        *((x, (top + bottom) / 2.0) for x in (left - half - 4.0, right + half + 4.0)),
        (middle, (top + bottom) / 2.0),
    ]
    ends = np.array([half, _BESIDE]), np.array(image.size) - [half, _BESIDE]
    at = [np.clip(side, *ends).tolist() for side in sides]
    boxes: list[Box] = [(x - half, y - 11.0, x + half, y + 11.0) for x, y in at]
    box = min(boxes, key=lambda one: sum(_shared(one, other) for other in taken))
    draw.rounded_rectangle(box, 5, _COLOURS[came])
    where = ((box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0)
    draw.text(where, words, "white" if came == "wrong" else "black", font, anchor="mm")
    return box


def _shared(one: Box, other: Box) -> float:
    """Return the intersection area of two boxes [pixel]."""
    across = min(one[2], other[2]) - max(one[0], other[0])
    down = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, across) * max(0.0, down)


def drawn(
    learnt: RecognitionModel, things: Sequence[ForeignThing], seed: int
) -> tuple[Image.Image, Counter[str]]:
    """Draw all tables, with a legend of the colours and counts."""
    rng, studio = np.random.default_rng(seed), Studio()
    panels, total = list[Picture](), Counter[str]()
    for stood in tables(things, rng):
        image, outcomes = panel(studio, stood, learnt, rng)
        panels.append(np.asarray(image))
        total += outcomes
    while len(panels) % ACROSS:
        panels.append(np.full_like(panels[0], 255))
    rows = [np.concatenate(panels[n : n + ACROSS], axis=1) for n in range(0, len(panels), ACROSS)]
    return _with_legend(Image.fromarray(np.concatenate(rows)), total), total


def _with_legend(picture: Image.Image, total: Counter[str]) -> Image.Image:
    whole = Image.new("RGB", (picture.width, picture.height + 40), "white")
    whole.paste(picture)
    draw, font, x, y = ImageDraw.Draw(whole), ImageFont.load_default(19), 14.0, picture.height + 20
    for came, words in _LEGEND.items():
        draw.rounded_rectangle((x, y - 9, x + 18, y + 9), 5, _COLOURS[came])
        draw.text((x + 26, y), f"{words}: {total[came]}", "black", font, anchor="lm")
        x += 26 + draw.textlength(f"{words}: {total[came]}", font) + 34
    return whole


def main() -> None:
    """Draw the sheet and print the counts of outcomes."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.perception.foreign_picture",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--things", type=Path, default=Path("../shared/data/foreign"))
    parser.add_argument("--samples", type=Path, help="train on these, without the drawn things")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    things = [thing for thing in foreign_things(options.things) if thing.learnable]
    if not things:
        parser.error(f"{options.things} holds no things that may be shown")
    unseen = [thing.name for thing in things]
    learnt = learn(read(options.samples), unseen=unseen) if options.samples else shipped()
    picture, total = drawn(learnt, things, options.seed)
    picture.quantize(256, dither=Image.Dither.NONE).save(options.out, optimize=True)
    print(f"{options.out}: {total.total()} things, {dict(total)}")


if __name__ == "__main__":
    main()
