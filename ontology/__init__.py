"""The household TBox, and a furnished flat to begin with: an ABox and the MJCF world it stands in."""

from pathlib import Path

_HERE = Path(__file__).resolve().parent  # in a checkout, `semmap.ontology` is a link

HOUSEHOLD_TTL = _HERE / "household.ttl"
"""The TBox."""
FLAT_TTL = _HERE / "flat.ttl"
"""An ABox: a flat of 10 m x 8 m with its rooms and furniture."""
FLAT_WORLD = _HERE / "flat_world.xml"
"""The flat's floor, walls, lights and cameras, without anything that is an entity of the ABox."""
EMPTY_WORLD = _HERE / "empty_world.xml"
"""A bare floor with a light and a camera."""
ALIGNMENTS = _HERE / "alignments"
"""What the vocabularies of other people's ontologies mean, a file each."""
MODEL_SHAPES_JSON = _HERE / "model_shapes.json"
"""The size, support surfaces and interiors of each of the simulator's models; see `model_shapes.py`."""
