"""The kinds of content that a tab shows or hides in its scene."""

from __future__ import annotations

from typing import Final, Literal

Switch = Literal[
    "names", "walls", "relations", "viewer-relative relations", "boxes", "observations", "cloud", "cameras"
]
SWITCHES: Final[dict[Switch, str]] = {
    "names": "Names of entities and places",
    "walls": "Walls of the world",
    "relations": "Computed relations of the selected entity",
    "viewer-relative relations": "Viewer-relative relations: left of, right of, in front of, behind",
    "boxes": "Bounding boxes of all entities",
    "observations": "Observations of perception",
    "cloud": "Point cloud of perception",
    "cameras": "Cameras and their images",
}
SWITCHED_ON: Final[frozenset[Switch]] = frozenset(("names", "walls", "relations"))
"""The switches that are on in a new tab."""
