"""Names of entities in replies that read like a text: an agent must not mistake them for instructions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from semmap.schemas.entities import names_in
from semmap.schemas.wording import reads_like_text


def list_names_like_text(value: Any) -> Iterator[str]:
    """Yield the names in a reply that read like a text, outside `said`, where texts are marked already."""
    if isinstance(value, str):  # a name, a name with a prefix, or a sentence with names
        yield from filter(reads_like_text, names_in(value))
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from list_names_like_text(key)
            if key not in _MARKED:
                yield from list_names_like_text(each)
    elif isinstance(value, Iterable):
        for each in value:
            yield from list_names_like_text(each)


_MARKED: Final = ("said", "token", "units", "class", "types", "rule")
"""The fields that cannot contain an unmarked name."""
