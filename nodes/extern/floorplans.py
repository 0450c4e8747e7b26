"""Floor plans as files: written for robots and people, and read from files of the ROS map server."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from semmap.nodes.extern.files import read_file, write_atomically
from semmap.nodes.runtime import extras
from semmap.schemas import codec, errors
from semmap.schemas.moments import When
from semmap.schemas.plans import HEIGHTS_M, HeightRange

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.navigation.loaded_plan import LoadedPlan
    from semmap.nodes.navigation.map_server import Pixels

RESOLUTION_M: Final = 0.05
_FINEST_M, _COARSEST_M = 0.005, 1.0
_KINDS: Final = "PNG or PGM (an occupancy grid), .svg (to print) or .geojson"


def write_floorplan(
    client: Client,
    file: Path,
    *,
    resolution: float = RESOLUTION_M,
    heights: HeightRange = HEIGHTS_M,
    as_of: When | None = None,
    furniture: bool = True,
) -> tuple[Path, ...]:
    """Write the floor plan of a map in the format of the suffix of `file`, and return the written files.

    A grid (`.png`, `.pgm`) is written with a `.yaml` file, as the ROS map server reads them. `resolution` is
    the cell size [m]. Objects with a part within `heights` [m] above the floor are occupied cells. If there
    are forbidden places, a mask of them is also written. Raises BadRequest, Refused.
    """
    extras.require("a floor plan", "kb")
    kind = file.suffix.lower()
    if kind not in (".png", ".pgm", ".svg", ".geojson"):
        raise errors.BadRequest(f"{file.name}: unknown floor plan format; supported: {_KINDS}")
    if not _FINEST_M <= resolution <= _COARSEST_M:
        raise errors.BadRequest(
            f"--resolution {resolution:g} is out of range; use {_FINEST_M:g} to {_COARSEST_M:g} m"
        )
    if not heights[0] < heights[1]:
        raise errors.BadRequest(f"--height-range {heights[0]:g} {heights[1]:g}: LOW must be less than HIGH")
    if kind == ".svg":
        return (_svg(client, file, as_of),)
    plan = client.floorplan(as_of=as_of)
    if kind == ".geojson":
        from semmap.nodes.navigation.geojson import geojson

        write_atomically(file, geojson(plan).encode())
        return (file,)

    from semmap.nodes.navigation import map_server
    from semmap.nodes.navigation.grid import forbidden_mask, occupancy

    encode: Callable[[map_server.Pixels], bytes] = map_server.png if kind == ".png" else map_server.pgm
    grid = occupancy(plan, resolution, heights, furniture=furniture)
    pictures = [(file, map_server.pixels_of(grid))]
    if any(place.forbidden for place in plan.places):
        mask = forbidden_mask(plan, grid.frame)
        pictures.append((file.with_name(f"{file.stem}_forbidden{file.suffix}"), map_server.mask_pixels(mask)))
    written: list[Path] = []
    for path, pixels in pictures:
        write_atomically(path, encode(pixels))
        described = path.with_suffix(".yaml")
        write_atomically(described, map_server.yaml_of(path.name, grid.frame).encode())
        written += [path, described]
    return tuple(written)


def _svg(client: Client, file: Path, as_of: When | None) -> Path:
    from semmap.nodes.extern.plan.floor import floor_of
    from semmap.nodes.extern.plan.svg import drawing

    entities = client.list(as_of=as_of)
    if not entities:
        raise errors.Refused("the map has no entities to draw")
    commits = client.history(until=as_of, limit=1)
    last = commits[-1]
    floor = floor_of(entities, plan=client.floorplan(as_of=as_of))
    text = drawing(floor, title="Floor plan", commit=last.seq, stamp_ns=last.stamp_ns)
    write_atomically(file, text.encode())
    return file


def is_plan(path: Path) -> bool:
    """Return whether a file is a plan, by its suffix."""
    return path.suffix.lower() in (".yaml", ".yml")


def read_plan(path: Path) -> LoadedPlan:
    """Return the rooms and doors of a plan, from its YAML file. Raises BadFile."""
    extras.require("a plan", "sim")
    from semmap.nodes.navigation.loaded_plan import loaded_plan
    from semmap.nodes.navigation.map_server import read_image, read_yaml

    try:
        text = codec.decode_text(read_file(path))
    except UnicodeDecodeError:
        raise errors.BadFile(f"{path.name} is not a UTF-8 text file") from None
    described = read_yaml(text, path.name)
    image = path.parent / described.image  # an absolute path stays absolute
    if not image.is_file():
        raise errors.BadFile(f"the image of {path.name} is missing: there is no file {image}")
    return loaded_plan(described, read_image(read_file(image), image.name, _png), path.name)


def _png(content: bytes) -> Pixels:
    import numpy as np

    from semmap.nodes.navigation.grid import MOST_CELLS
    from semmap.nodes.runtime.pictures import open_picture

    try:
        with open_picture(content, MOST_CELLS) as picture:
            return np.asarray(picture.convert("L"), dtype=np.uint8)
    except ValueError as error:
        raise errors.BadFile(f"the plan cannot be read: {error}") from None
