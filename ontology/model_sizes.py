"""How large the simulator's models are: the size of an entity of which nobody said one."""

from __future__ import annotations

from functools import cache

import msgspec

from ontology import MODEL_SIZES_JSON
from schemas.entities import Size


def own_size_m(model: str) -> Size | None:
    """Extent of a model of the library along its own axes [m]; of "" that of the box which stands in for one.

    None for a model from a file of the user's: only the simulator knows it.
    """
    return _sizes().get(model)


@cache
def _sizes() -> dict[str, Size]:
    return msgspec.json.decode(MODEL_SIZES_JSON.read_bytes(), type=dict[str, Size])
