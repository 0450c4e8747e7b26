"""Masks in files: COCO's JSON, or label images."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from nodes.perception_node.input.files.image_files import opened
from nodes.perception_node.input.masks import Masks, of_numbers, of_runs
from schemas.errors import BadFile
from schemas.perception import MaskRun

_WANTED = (
    "a list of masks as COCO writes results, a dataset with annotations and categories, or a label image"
)


def read_masks(path: Path, height: int, width: int) -> Masks:
    """The masks in a .json, .png or .npy file for a picture of this size. Raises BadFile."""
    try:
        match path.suffix.lower():
            case ".json":
                return of_runs(_runs(path.read_bytes()), height, width)
            case ".png":
                with opened(path) as image:
                    numbers = np.asarray(image)
            case ".npy":
                numbers = np.load(io.BytesIO(path.read_bytes()), allow_pickle=False)
            case other:
                raise ValueError(f"masks are .json, .png or .npy files, not '{other}'")
        if numbers.shape != (height, width) or numbers.dtype.kind not in "iu":
            raise ValueError(
                f"a label image for this picture has {width} x {height} whole numbers; this one is of shape"
                f" {' x '.join(map(str, numbers.shape[::-1]))} with {numbers.dtype}"
            )
        return of_numbers(numbers)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except (ValueError, msgspec.DecodeError) as error:
        raise BadFile(f"{path}: {error}") from None


def _runs(data: bytes) -> list[MaskRun]:
    """Masks, with labels where there are names of categories. Raises ValueError."""
    try:
        found = msgspec.json.decode(data)
    except msgspec.DecodeError as error:
        raise ValueError(f"not JSON: {error}") from None
    names: dict[Any, str] = {}
    if isinstance(found, dict):
        names = {told.get("id"): str(told.get("name", "")) for told in found.get("categories", ())}
        found = found.get("annotations")
    if not isinstance(found, list):
        raise ValueError(f"expected {_WANTED}")
    return [_run(told, names) for told in found]


def _run(told: Any, names: dict[Any, str]) -> MaskRun:
    if not isinstance(told, dict) or not isinstance(told.get("segmentation"), dict):
        raise ValueError(
            "each mask needs a segmentation with size and counts (RLE); polygons are not supported"
        )
    category = told.get("category_id")
    label = told.get("category") or told.get("label") or names.get(category) or ""
    if not label and category is not None:
        label = str(category)
    code = told["segmentation"]
    return msgspec.convert(
        {
            "size": code.get("size"),
            "counts": code.get("counts"),
            "label": label,
            "score": told.get("score", 1.0),
        },
        MaskRun,
    )
