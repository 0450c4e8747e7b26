"""The names of a detector's classes: of a file, of the model itself, or of COCO."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path

from semmap.schemas.errors import BadFile
from semmap.schemas.perception import COCO

_COCO = (
    "person, bicycle, car, motorcycle, airplane, bus, train, truck, boat, traffic light, fire hydrant, stop"
    " sign, parking meter, bench, bird, cat, dog, horse, sheep, cow, elephant, bear, zebra, giraffe,"
    " backpack, umbrella, handbag, tie, suitcase, frisbee, skis, snowboard, sports ball, kite, baseball bat,"
    " baseball glove, skateboard, surfboard, tennis racket, bottle, wine glass, cup, fork, knife, spoon,"
    " bowl, banana, apple, sandwich, orange, broccoli, carrot, hot dog, pizza, donut, cake, chair, couch,"
    " potted plant, bed, dining table, toilet, tv, laptop, mouse, remote, keyboard, cell phone, microwave,"
    " oven, toaster, sink, refrigerator, book, clock, vase, scissors, teddy bear, hair drier, toothbrush"
)
_COCO_GAPS = frozenset({0, 12, 26, 29, 30, 45, 66, 68, 69, 71, 83})
"""Numbers of COCO's categories, of which there are 90, without a class."""

COCO_80 = tuple(_COCO.split(", "))
"""The classes in order, as YOLO and RT-DETR number them."""


def _coco_91() -> tuple[str, ...]:
    names = iter(COCO_80)
    return tuple("" if number in _COCO_GAPS else next(names) for number in range(91))


COCO_91 = _coco_91()
"""The classes by their number in COCO's files, as RF-DETR numbers them; "" for a number without a class."""
_MOST = 100_000
"""A larger number of a class is an error; the longest lists of classes, as of ImageNet, have 22,000."""


def read_names(path: Path) -> tuple[str, ...]:
    """Return the names in a text file, one per line in the order of the classes. Raises BadFile."""
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise BadFile(f"{path} is not a text file with the name of a class in each line") from None
    names = tuple(line.strip() for line in lines)
    while names and not names[-1]:
        names = names[:-1]
    if not names:
        raise BadFile(f"{path} is empty; write the name of a class in each line")
    return names


def names_of(
    given: tuple[str, ...] | None, metadata: Mapping[str, str], classes: int, file: str
) -> tuple[str, ...]:
    """Return the names by number of a model's classes; `classes` is their number, 0 if unknown.

    They are those `given`, or those in the metadata, as Ultralytics writes them, or else COCO's, if the model
    has as many classes. A model may have one class more, for no thing. Raises BadFile without names, or with
    names of another number of classes.
    """
    named = given if given is not None else _of_metadata(metadata.get("names", ""))
    if not named:
        if classes in (len(COCO_80), len(COCO_91)):
            return coco_names(classes)
        count = f"its {classes} classes" if classes else "its classes"
        raise BadFile(
            f"{file} does not name {count}; add --detector-names FILE.txt, one name per line, or"
            f" --detector-names {COCO}"
        )
    if classes and len(named) not in (classes, classes - 1):
        raise BadFile(f"{file} has {classes} classes, but there are {len(named)} names; each class needs one")
    return named


def coco_names(classes: int) -> tuple[str, ...]:
    """Return the names of COCO's classes for a model with this number of classes, 0 if unknown.

    A model may have one class more, for no thing.
    """
    return COCO_91 if classes in (len(COCO_91), len(COCO_91) + 1) else COCO_80


def _of_metadata(text: str) -> tuple[str, ...]:
    """Return the names in a Python literal `{0: 'cup', 1: 'plate'}`; empty if it is not one."""
    try:
        found = ast.literal_eval(text) if text else {}
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        return ()
    if isinstance(found, list):
        found = dict(enumerate(found))
    if not isinstance(found, dict) or not all(
        isinstance(number, int) and 0 <= number < _MOST for number in found
    ):
        return ()
    return tuple(str(found.get(number, "")) for number in range(max(found, default=-1) + 1))
