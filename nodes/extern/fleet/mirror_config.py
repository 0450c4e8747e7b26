"""The settings of a mirror from texts: URLs, robots, frames, endpoints."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from semmap.nodes import bus
from semmap.nodes.extern.connection import identity as identify
from semmap.nodes.extern.fleet import frames as frames_
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.mirror import Mirror, MirrorConfig
from semmap.nodes.extern.fleet.robots import endpoints, split_names


def config(
    update_url: str,
    query_url: str | None = None,
    *,
    robots: str | Sequence[str] = "*",
    frames: Sequence[str] | Mapping[str, Frame] = (),
    where: str | Sequence[str] | None = None,
    identity: str | None = None,
) -> MirrorConfig:
    """Return the settings of a mirror. Raises BadRequest, BadFile."""
    certificate = identify(identity)
    reached = endpoints(where)
    return MirrorConfig(
        update_url=update_url,
        query_url=query_url or query_url_of(update_url),
        robots=split_names(robots),
        frames=dict(frames) if isinstance(frames, Mapping) else frames_.read(frames),
        endpoints=reached if certificate is None else tuple(map(bus.to_tls, reached)),
        identity=certificate,
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
    """Return a mirror of the robots whose names match; `run()` starts it, `stop()` ends it.

    It writes to the SPARQL 1.1 server at `update_url`. `frames` are the poses of the robots' maps in the
    fleet frame, as `robot1=X,Y,Z,YAW` [m, rad] or by name. `tell` receives log messages. Raises BadRequest,
    BadFile.
    """
    settings = config(update_url, query_url, robots=robots, frames=frames, where=where, identity=identity)
    return Mirror(settings, tell)


def query_url_of(update_url: str) -> str:
    """Return `.../query` for `.../update`, or the same URL if it does not contain `update`."""
    head, slash, last = update_url.rpartition("/")
    return f"{head}{slash}{last.replace('update', 'query', 1)}"
