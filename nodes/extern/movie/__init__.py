"""A movie of a span of the map's history.

`wanted.py` says what it is to be like, `storyboard.py` what is seen when, and `filming.py` films it.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from msgspec import structs

from semmap.nodes.extern.journal_copy import journal_copy
from semmap.nodes.extern.movie.film import Film
from semmap.nodes.extern.replay import read_settings
from semmap.nodes.runtime import extras
from semmap.schemas import errors

__all__ = ["Film", "movie"]


def movie(
    file: str | Path,
    wanted: Film,
    *,
    data: str | Path | None = None,
    where: str | None = None,
    identity: str | None = None,
    namespace: str | None = None,
    overwrite: bool = False,
    tell: Callable[[str], None] = lambda text: None,
) -> str:
    """Film a span of the history of the map in the data folder `data`, or else of a running system.

    Neither is touched; the file appears when it is whole. Returns what there is to say of it, in a sentence;
    `tell` is told how far it is. Raises BadFile for a file that cannot be written, or is there and not to be
    overwritten; Refused for a span that is not in the history; BadRequest for what no movie can be like.
    """
    file, data = Path(file), None if data is None else Path(data)
    wanted.validate()
    if file.suffix.lower() != ".mp4":
        raise errors.BadRequest(f"movies are written as MP4; name the file {file.stem or 'movie'}.mp4")
    if file.exists() and not overwrite:
        raise errors.BadFile(f"{file} already exists; add --overwrite or choose another name")
    if not file.absolute().parent.is_dir():
        raise errors.BadFile(f"there is no folder {file.absolute().parent}")
    extras.require("semmap movie", "kb", "sim", "movie")
    from semmap.nodes.extern.movie.rendering import render_video
    from semmap.nodes.kb_node.storage.journal import Journal

    unfinished = file.with_name(f".{file.stem}.part.mp4")
    with (
        journal_copy("semmap movie", data, where=where, identity=identity, namespace=namespace) as copy,
        closing(Journal(copy.path)) as journal,
    ):
        if copy.data is not None:
            settings = read_settings(copy.data, wanted.world)
            models = None if settings.models is None else Path(settings.models)
            wanted = structs.replace(wanted, world=Path(settings.world), models=models, data=copy.data)
        try:
            told = render_video(journal, unfinished, wanted, tell)
            unfinished.replace(file)
        finally:
            unfinished.unlink(missing_ok=True)
    return told.replace(str(unfinished), str(file))
