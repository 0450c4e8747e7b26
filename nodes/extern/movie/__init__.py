"""Videos of a period of the history.

`film.py` has the settings, `storyboard.py` computes the scenes, and `rendering.py` renders them.
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
    """Export a video of a period of the history of the map in `data`, or of a running system.

    The map is only read. The file is created when the video is complete. Returns a summary; `tell` receives
    progress messages. Raises BadFile if the file cannot be written, or exists and `overwrite` is not set.
    Raises Refused for a period that is not in the history, and BadRequest for invalid settings.
    """
    file, data = Path(file), None if data is None else Path(data)
    wanted.require_sound()
    if file.suffix.lower() != ".mp4":
        raise errors.BadRequest(f"{file}: the suffix must be .mp4, as in {file.stem or 'movie'}.mp4")
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
            summary = render_video(journal, unfinished, wanted, tell)
            unfinished.replace(file)
        finally:
            unfinished.unlink(missing_ok=True)
    return summary.replace(str(unfinished), str(file))
