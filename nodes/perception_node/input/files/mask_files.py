"""Masks in files: JSON of COCO or labelme, XML of CVAT, text of YOLO, label images, or arrays."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.files.array_files import open_array
from semmap.nodes.perception_node.input.files.cvat_masks import cvat_runs
from semmap.nodes.perception_node.input.files.mask_polygons import counts_of
from semmap.nodes.perception_node.input.masks import (
    Masks,
    masks_from_numbers,
    masks_from_runs,
    masks_from_stack,
)
from semmap.nodes.runtime.pictures import open_picture
from semmap.schemas import codec
from semmap.schemas.errors import BadFile
from semmap.schemas.perception import MaskRun
from semmap.schemas.wording import few, sentence

_WANTED = "a list of masks (COCO results), a dataset with annotations and categories, or shapes (labelme)"
_CLASSES = "classes.txt"
_MOST_BYTES = 2_000_000_000
_SURE = 0.5
"""Minimum of a mask of floats, which may be probabilities."""


def read_masks(path: Path, height: int, width: int) -> Masks:
    """Return the masks in a file for an image of this size. Raises BadFile.

    It is .json of COCO or labelme, .xml of CVAT, .txt of YOLO with a `classes.txt` beside or above it, a
    label image (.png, .npy), or boolean masks (N, H, W) as .npy, or as .npz with `masks` and optional `names`
    and `scores`.
    """
    try:
        match path.suffix.lower():
            case ".json":
                return masks_from_runs(_runs(path.read_bytes(), height, width), height, width)
            case ".xml":
                return masks_from_runs(cvat_runs(path.read_bytes(), height, width), height, width)
            case ".txt":
                return masks_from_runs(_yolo_runs(path, height, width), height, width)
            case ".npz":
                return _of_archive(path, height, width)
            case ".png":
                with open_picture(path) as image:
                    numbers = np.asarray(image)
            case ".npy":
                numbers = open_array(path)
                if numbers.dtype == bool:
                    return masks_from_stack(_stack(numbers, height, width))
            case other:
                raise ValueError(f"masks are .json, .xml, .txt, .png, .npy or .npz files, not '{other}'")
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


def _stack(masks: NDArray[Any], height: int, width: int) -> NDArray[np.bool_]:
    """Return masks (N, H, W) that are given in this order, or as (H, W, N) or (H, W). Raises ValueError."""
    if masks.ndim == 2:
        masks = masks[None]
    elif masks.ndim == 3 and masks.shape[1:] != (height, width) and masks.shape[:2] == (height, width):
        masks = np.moveaxis(masks, 2, 0)
    if masks.ndim != 3 or masks.shape[1:] != (height, width):
        shape = " x ".join(map(str, masks.shape))
        raise ValueError(f"masks for this image must be an array N x {height} x {width}; this one is {shape}")
    return np.asarray(masks > _SURE if masks.dtype.kind == "f" else masks, bool)


def _of_archive(path: Path, height: int, width: int) -> Masks:
    """Return the masks in an archive: one for each thing, or a label image (H, W) of several numbers."""
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > _MOST_BYTES:
                raise ValueError(f"its arrays have more than {_MOST_BYTES:,} bytes")
        with np.load(path, allow_pickle=False) as arrays:
            if "masks" not in arrays.files:
                raise ValueError(f"it has no array named masks, only {few(arrays.files) or 'none'}")
            masks = arrays["masks"]
            names = [n.decode() if isinstance(n, bytes) else str(n) for n in _listed(arrays, "names")]
            scores = [float(score) for score in _listed(arrays, "scores")]
            if masks.shape == (height, width) and len(np.unique(masks[masks != 0])) > 1:
                return masks_from_numbers(masks.astype(np.int64), names, scores)
            return masks_from_stack(_stack(masks, height, width), names, scores)
    except (zipfile.BadZipFile, EOFError):
        raise ValueError("not an .npz archive of arrays, or a truncated one") from None


def _listed(arrays: Mapping[str, NDArray[Any]], name: str) -> list[Any]:
    """Return the values of an array, also of a column or of a single value; empty if it is absent."""
    return np.ravel(arrays[name]).tolist() if name in arrays else []


def _yolo_runs(path: Path, height: int, width: int) -> list[MaskRun]:
    """Return the masks in lines of a class, x and y of the corners as shares of the image, and a score.

    A line with four shares is a box: middle, width and height. Raises ValueError and OSError.
    """
    listed = next((file for of in path.absolute().parents[:2] if (file := of / _CLASSES).exists()), None)
    names = [] if listed is None else listed.read_text("utf-8-sig", "replace").split("\n")
    found = []
    for number, line in enumerate(path.read_text("utf-8-sig", "replace").splitlines(), 1):
        if not (words := line.split()):
            continue
        try:
            kind, shares = int(words[0]), [float(word) for word in words[1:]]
            score = shares.pop() if len(shares) % 2 else 1.0
            if len(shares) < 4 or not 0.0 <= score <= 1.0 or kind < 0:
                raise ValueError
        except ValueError:
            raise ValueError(
                f"line {number} is not a class, x and y of the corners from 0 to 1, and optionally a score"
            ) from None
        if len(shares) == 4:
            x, y, w, h = shares
            low_x, low_y, high_x, high_y = x - w / 2, y - h / 2, x + w / 2, y + h / 2
            shares = [low_x, low_y, high_x, low_y, high_x, high_y, low_x, high_y]
        corners = [share * (height if n % 2 else width) for n, share in enumerate(shares)]
        label = names[kind].strip() if kind < len(names) else ""
        counts = tuple(counts_of([corners], height, width))
        found.append(MaskRun(size=(height, width), counts=counts, label=label or str(kind), score=score))
    return found


def _of_shape(shape: Any) -> dict[str, Any]:
    """Return a shape of labelme as a mask of COCO. Raises ValueError."""
    if not isinstance(shape, dict) or not isinstance(points := shape.get("points"), list):
        raise ValueError("each shape needs a label and points")
    kind = shape.get("shape_type") or "polygon"
    if kind not in ("polygon", "rectangle"):
        raise ValueError(f"a shape is of the type '{kind}'; use polygon or rectangle")
    try:
        if kind == "rectangle":
            (left, top), (right, bottom) = points
            points = [[left, top], [right, top], [right, bottom], [left, bottom]]
        corners = [number for x, y in points for number in (x, y)]
    except (TypeError, ValueError):
        raise ValueError("the points of a shape must be pairs of numbers") from None
    return {"segmentation": [corners], "label": shape.get("label", "")}


def _require_size(found: Mapping[str, Any], height: int, width: int) -> None:
    """Raise ValueError if a file of labelme or COCO names another image size."""
    images = found.get("images")
    image = images[0] if isinstance(images, list) and len(images) == 1 else found
    across, down = ("width", "height") if image is not found else ("imageWidth", "imageHeight")
    size = (image.get(across), image.get(down)) if isinstance(image, dict) else (None, None)
    if None not in size and size != (width, height):
        raise ValueError(
            f"its masks are for an image of {size[0]} x {size[1]} pixels, not {width} x {height}"
        )


def _runs(data: bytes, height: int, width: int) -> list[MaskRun]:
    """Return masks, with labels if there are category names. Raises ValueError."""
    try:
        found = codec.decode_json(codec.decode_text(data))
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"not JSON: {error}") from None
    names: dict[str, str] = {}
    if isinstance(found, dict):
        _require_size(found, height, width)
    if isinstance(found, dict) and isinstance(shapes := found.get("shapes"), list):
        found = [_of_shape(shape) for shape in shapes]
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
