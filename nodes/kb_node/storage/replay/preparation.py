"""The journals of a replay: a full copy, and a map that ends where the replay begins."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path
from typing import Final

from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.replay import journal_copy
from semmap.nodes.kb_node.storage.replay.spans import Span, span_of
from semmap.schemas import errors
from semmap.schemas.moments import When

SOURCE: Final = f"replayed-{FILENAME}"
"""The copy that provides the commits, in the folder of the replay."""


def prepare(data: Path, folder: Path, *, since: When | None = None, until: When | None = None) -> Span:
    """Create the journals in `folder` for a replay of the map in `data`, and return its span.

    The shapes of the bodies of its worlds are copied, too.

    Raises BadFile if there is no map. Raises Refused if it is damaged up to the end of the span or lacks
    the span, BadRequest for an invalid span.
    """
    source = folder / SOURCE
    journal_copy.copy(data, source)
    try:
        with closing(Journal(source)) as journal:
            span = span_of(journal, since, until)
            _require_intact(journal, span.until)
    except errors.Refused as error:
        raise journal_copy.name_original(error, source, data / FILENAME) from None
    shutil.copyfile(source, folder / FILENAME)
    journal_copy.truncate(folder / FILENAME, span.since)
    body_shapes.copy(data, folder)
    return span


def _require_intact(journal: Journal, until: int) -> None:
    """Raise Refused for damage up to a commit. Later damage does not matter."""
    for row in journal.rows():
        if row.seq >= until:
            break
