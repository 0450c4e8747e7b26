"""Masks in files: COCO's JSON, or label images."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from semmap.nodes.perception_node.input.files.image_files import opened
from semmap.nodes.perception_node.input.files.mask_polygons import counts_of
from semmap.nodes.perception_node.input.masks import Masks, masks_from_numbers, masks_from_runs
from semmap.schemas.errors import BadFile
from semmap.schemas.perception import MaskRun
from semmap.schemas.wording import sentence

_WANTED = (
    "a list of masks as COCO writes results, a dataset with annotations and categories, or a label image"
)


def read_masks(path: Path, height: int, width: int) -> Masks:
    """The masks in a .json, .png or .npy file for a picture of this size. Raises BadFile."""
    try:
        match path.suffix.lower():
            case ".json":
                return masks_from_runs(_runs(path.read_bytes(), height, width), height, width)
            case ".png":
                with opened(path) as image:
                    numbers = np.asarray(image)
            case ".npy":
                numbers = np.lib.format.read_array(io.BytesIO(path.read_bytes()), allow_pickle=False)
            case other:
                raise ValueError(f"masks are .json, .png or .npy files, not '{other}'")
        if numbers.shape != (height, width) or numbers.dtype.kind not in "iu":
            across_first = (*numbers.shape[1::-1], *numbers.shape[2:])
            raise ValueError(
                f"a label image for this picture has {width} x {height} whole numbers; this one has"
                f" {' x '.join(map(str, across_first))} of {numbers.dtype}"
            )
        return masks_from_numbers(numbers)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path}: {error}") from None


def _runs(data: bytes, height: int, width: int) -> list[MaskRun]:
    """Masks, with labels where there are names of categories. Raises ValueError."""
    try:
        found = msgspec.json.decode(data)
    except msgspec.DecodeError as error:
        raise ValueError(f"not JSON: {error}") from None
    names: dict[str, str] = {}
    if isinstance(found, dict):
        listed = found.get("categories") or []
        if not isinstance(listed, list) or not all(isinstance(told, dict) for told in listed):
            raise ValueError('categories are a list such as [{"id": 1, "name": "cup"}]')
        names = {str(told.get("id")): str(told.get("name", "")) for told in listed}
        found = found.get("annotations")
    if not isinstance(found, list):
        raise ValueError(f"expected {_WANTED}")
    pictures = {str(told["image_id"]) for told in found if isinstance(told, dict) and "image_id" in told}
    if len(pictures) > 1:
        raise ValueError(
            f"it has masks of {len(pictures)} pictures (image_id); each picture needs its own file"
        )
    return [_run(told, names, height, width) for told in found]


def _run(told: Any, names: dict[str, str], height: int, width: int) -> MaskRun:
    code = told.get("segmentation") if isinstance(told, dict) else None
    if isinstance(code, list) and code:
        code = {"size": (height, width), "counts": counts_of(code, height, width)}
    if not isinstance(told, dict) or not isinstance(code, dict):
        raise ValueError("each mask needs a segmentation: size and counts (RLE), or a list of polygons")
    category = told.get("category_id")
    label = told.get("category") or told.get("label") or names.get(str(category)) or ""
    if not label and category is not None:
        label = str(category)
    mask = {
        "size": code.get("size"),
        "counts": code.get("counts"),
        "label": label,
        "score": told.get("score", 1.0),
    }
    try:
        return msgspec.convert(mask, MaskRun)
    except msgspec.ValidationError as error:
        raise ValueError(f"a mask's {sentence(error, MaskRun)}") from None
