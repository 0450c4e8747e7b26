"""Plan files of the ROS map server: a YAML file and its image."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from semmap.nodes.extern.files import read_file
from semmap.nodes.runtime import extras
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.navigation.loaded_plan import LoadedPlan
    from semmap.nodes.navigation.map_server import Pixels


def is_plan(path: Path) -> bool:
    """Return whether a file is a plan, by its suffix."""
    return path.suffix.lower() in (".yaml", ".yml")


def read_plan(path: Path) -> LoadedPlan:
    """Return the rooms and doors of a plan, from its YAML file. Raises BadFile."""
    extras.require("a plan", "sim")
    from semmap.nodes.navigation.loaded_plan import loaded_plan
    from semmap.nodes.navigation.map_server import read_image, read_yaml

    try:
        text = read_file(path).decode()
    except UnicodeDecodeError:
        raise errors.BadFile(f"{path.name} is not a UTF-8 text file") from None
    described = read_yaml(text, path.name)
    image = path.parent / described.image  # an absolute path stays absolute
    if not image.is_file():
        raise errors.BadFile(f"the image of {path.name} is missing: there is no file {image}")
    return loaded_plan(described, read_image(read_file(image), image.name, _png), path.name)


def _png(content: bytes) -> Pixels:
    import numpy as np
    from PIL import Image

    from semmap.nodes.navigation.grid import MOST_CELLS

    try:
        with Image.open(io.BytesIO(content)) as picture:
            width, height = picture.size
            if width * height > MOST_CELLS:
                raise errors.BadFile(
                    f"the image has {width} x {height} pixels; the maximum is {MOST_CELLS:,} pixels"
                )
            return np.asarray(picture.convert("L"), dtype=np.uint8)
    except (OSError, SyntaxError, ValueError) as error:
        raise errors.BadFile(f"the image is not a readable PNG file: {error}") from None
