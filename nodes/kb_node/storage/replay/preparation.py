"""The journals of a replay: a copy of the whole, and a map that ends where the replay begins."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path
from typing import Final

from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.replay import journal_copy
from semmap.nodes.kb_node.storage.replay.spans import Span, span_of
from semmap.schemas import errors
from semmap.schemas.moments import When

SOURCE: Final = f"replayed-{FILENAME}"
"""The copy that the commits come from, in the folder of the replay."""


def prepare(data: Path, folder: Path, *, since: When | None = None, until: When | None = None) -> Span:
    """Make the journals in `folder` for a replay of the map in the data folder `data`; the span it has.

    Raises BadFile when there is no map, Refused when it is damaged up to the end of the span or the span is
    not there, BadRequest when the span is none.
    """
    source = folder / SOURCE
    journal_copy.copy(data, source)
    try:
        with closing(Journal(source)) as journal:
            span = span_of(journal, since, until)
            _require_sound(journal, span.until)
    except errors.Refused as error:
        raise journal_copy.name_original(error, source, data / FILENAME) from None
    shutil.copyfile(source, folder / FILENAME)
    journal_copy.truncate(folder / FILENAME, span.since)
    return span


def _require_sound(journal: Journal, until: int) -> None:
    """Raises Refused for damage among the commits up to one; what comes later is not needed."""
    for row in journal.rows():
        if row.seq >= until:
            break
