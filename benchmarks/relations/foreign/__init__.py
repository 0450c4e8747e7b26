"""Relations in MJCF worlds that were not made for semmap, compared with physics."""

from benchmarks.relations.foreign import (
    first_kitchens,
    first_rooms,
    first_tables,
    later_checks,
    later_odd,
    later_rooms,
    later_storage,
)

FIRST = (*first_kitchens.WORLDS, *first_tables.WORLDS, *first_rooms.WORLDS)
"""The worlds that were drawn before the code of relations was read. They are not changed."""
LATER = (*later_storage.WORLDS, *later_rooms.WORLDS, *later_odd.WORLDS, *later_checks.WORLDS)
