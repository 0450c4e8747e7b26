"""What a mirror is told in words: URLs, robots, frames, endpoints."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from semmap.nodes import bus
from semmap.nodes.extern.connection import identity as identify
from semmap.nodes.extern.fleet import frames as frames_
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.mirror import Mirror, MirrorConfig
from semmap.nodes.extern.fleet.robots import endpoints, words


def config(
    update_url: str,
    query_url: str | None = None,
    *,
    robots: str | Sequence[str] = "*",
    frames: Sequence[str] | Mapping[str, Frame] = (),
    where: str | Sequence[str] | None = None,
    identity: str | None = None,
) -> MirrorConfig:
    """The settings of a mirror. Raises BadRequest, BadFile."""
    who = identify(identity)
    reached = endpoints(where)
    return MirrorConfig(
        update_url=update_url,
        query_url=query_url or query_url_of(update_url),
        robots=words(robots),
        frames=dict(frames) if isinstance(frames, Mapping) else frames_.read(frames),
        endpoints=reached if who is None else tuple(map(bus.to_tls, reached)),
        identity=who,
    )


def mirror(
    update_url: str,
    query_url: str | None = None,
    *,
    robots: str | Sequence[str] = "*",
    frames: Sequence[str] | Mapping[str, Frame] = (),
    where: str | Sequence[str] | None = None,
    identity: str | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Mirror:
    """A mirror of the robots whose names match, which `run()` sets to work until `stop()`.

    It writes to the SPARQL 1.1 server at `update_url`. `frames` say where robots' maps are in the fleet's
    frame, as `robot1=X,Y,Z,YAW` [m, rad] or by name. `tell` is called with what a person wants to know.
    Raises BadRequest, BadFile.
    """
    settings = config(update_url, query_url, robots=robots, frames=frames, where=where, identity=identity)
    return Mirror(settings, tell)


def query_url_of(update_url: str) -> str:
    """`.../query` for `.../update`; a server without such a word has one endpoint for both."""
    head, slash, last = update_url.rpartition("/")
    return f"{head}{slash}{last.replace('update', 'query', 1)}"
