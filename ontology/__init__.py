"""The household TBox, and an example flat: an ABox and its MJCF world."""

from pathlib import Path

_HERE = Path(__file__).resolve().parent  # in a checkout, `semmap.ontology` is a link

HOUSEHOLD_TTL = _HERE / "household.ttl"
"""The TBox."""
FLAT_TTL = _HERE / "flat.ttl"
"""An ABox: a flat of 10 m x 8 m with its rooms and furniture."""
FLAT_WORLD = _HERE / "flat_world.xml"
"""The flat's floor, walls, lights and cameras, without anything that is an entity of the ABox."""
FLAT_START_M = (7.4, 2.0, 0.0)
"""A free place in the flat, where a new robot begins; the origin is inside a wall."""
EMPTY_WORLD = _HERE / "empty_world.xml"
"""A bare floor with a light and a camera."""
ALIGNMENTS = _HERE / "alignments"
"""The alignments with other vocabularies, one file each."""
MODEL_SHAPES_JSON = _HERE / "model_shapes.json"
"""The size, support surfaces and interiors of each of the simulator's models; see `model_shapes.py`."""
