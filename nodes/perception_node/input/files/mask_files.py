"""Masks in files: COCO JSON, or label images."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from semmap.nodes.perception_node.input.files.mask_polygons import counts_of
from semmap.nodes.perception_node.input.masks import Masks, masks_from_numbers, masks_from_runs
from semmap.nodes.runtime.pictures import open_picture
from semmap.schemas.errors import BadFile
from semmap.schemas.perception import MaskRun
from semmap.schemas.wording import sentence

_WANTED = "a list of masks (COCO results), a dataset with annotations and categories, or a label image"


def read_masks(path: Path, height: int, width: int) -> Masks:
    """Return the masks in a .json, .png or .npy file for an image of this size. Raises BadFile."""
    try:
        match path.suffix.lower():
            case ".json":
                return masks_from_runs(_runs(path.read_bytes(), height, width), height, width)
            case ".png":
                with open_picture(path) as image:
                    numbers = np.asarray(image)
            case ".npy":
                numbers = np.lib.format.open_memmap(path, mode="r")  # its header may claim any size
            case other:
                raise ValueError(f"masks are .json, .png or .npy files, not '{other}'")
        if numbers.shape != (height, width) or numbers.dtype.kind not in "iu":
            across_first = (*numbers.shape[1::-1], *numbers.shape[2:])
            raise ValueError(
                f"a label image for this image must have {width} x {height} integers; this one has"
                f" {' x '.join(map(str, across_first))} of {numbers.dtype}"
            )
        return masks_from_numbers(numbers)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path}: {error}") from None


def _runs(data: bytes, height: int, width: int) -> list[MaskRun]:
    """Return masks, with labels if there are category names. Raises ValueError."""
    try:
        found = msgspec.json.decode(data)
    except msgspec.DecodeError as error:
        raise ValueError(f"not JSON: {error}") from None
    names: dict[str, str] = {}
    if isinstance(found, dict):
        listed = found.get("categories") or []
        if not isinstance(listed, list) or not all(isinstance(entry, dict) for entry in listed):
            raise ValueError('categories are a list such as [{"id": 1, "name": "cup"}]')
        names = {str(entry.get("id")): str(entry.get("name", "")) for entry in listed}
        found = found.get("annotations")
    if not isinstance(found, list):
        raise ValueError(f"expected {_WANTED}")
    images = {str(entry["image_id"]) for entry in found if isinstance(entry, dict) and "image_id" in entry}
    if len(images) > 1:
        raise ValueError(f"it has masks of {len(images)} images (image_id); use one file per image")
    return [_run(entry, names, height, width) for entry in found]


def _run(entry: Any, names: dict[str, str], height: int, width: int) -> MaskRun:
    code = entry.get("segmentation") if isinstance(entry, dict) else None
    if isinstance(code, list) and code:
        code = {"size": (height, width), "counts": counts_of(code, height, width)}
    if not isinstance(entry, dict) or not isinstance(code, dict):
        raise ValueError("each mask needs a segmentation: size and counts (RLE), or a list of polygons")
    category = entry.get("category_id")
    label = entry.get("category") or entry.get("label") or names.get(str(category)) or ""
    if not label and category is not None:
        label = str(category)
    mask = {
        "size": code.get("size"),
        "counts": code.get("counts"),
        "label": label,
        "score": entry.get("score", 1.0),
    }
    try:
        return msgspec.convert(mask, MaskRun)
    except msgspec.ValidationError as error:
        raise ValueError(f"a mask's {sentence(error, MaskRun)}") from None
