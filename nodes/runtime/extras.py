"""The optional parts of semmap: `pip install 'semmap[sim]'`. Without extras it is a client.

A command or a node reports a missing extra before it does anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.util import find_spec

from semmap.schemas import errors

MODULES: Mapping[str, tuple[str, ...]] = {
    "kb": (
        *("numpy", "owlrl", "psutil", "pycrfsuite", "pyhornedowl", "pyoxigraph", "pyshacl"),
        *("rapidfuzz", "rdflib", "supervisor"),
    ),
    "sim": ("PIL", "mujoco", "numpy", "scipy", "trimesh"),
    "perception": ("PIL", "numpy", "scipy"),  # and Open3D, where there is one
    "record": ("PIL", "numpy", "rerun"),
    "keys": ("cryptography",),
    "mcp": ("anyio", "mcp", "uvicorn"),
    "web": ("fastapi", "nicegui", "numpy", "psutil", "uvicorn", "viser", "websockets"),
    "movie": ("av", "numpy"),
    "ros": ("mcap", "numpy", "rosbags"),
}
"""The modules that each extra installs."""

OF_NODE: Mapping[str, str] = {
    "router": "kb",
    "coordinator": "kb",
    "kb_node": "kb",
    "sim_node": "sim",
    "perception_node": "perception",
    "recorder": "record",
    "web": "web",
}
"""The extra that each node, and the web page, needs."""

_OPTIONS = {"sim": "--no-sim", "record": "--no-record"}
"""The options of `semmap up` that avoid an extra."""


def missing(extras: Iterable[str]) -> list[str]:
    """Return the extras of which a module is not installed."""
    return [extra for extra in dict.fromkeys(extras) if any(find_spec(m) is None for m in MODULES[extra])]


def require(what: str, *extras: str) -> None:
    """Raise BadRequest, with the command to install, if an extra is missing."""
    if lacking := missing(extras):
        raise errors.BadRequest(f"{what}: missing optional packages; install: {_install(lacking)}")


def require_nodes(nodes: Iterable[str], *, named: bool = False) -> None:
    """Raise BadRequest if `semmap up` lacks an extra; the message also has options that avoid it.

    There are none if the nodes were `named`.
    """
    if not (lacking := missing(["kb", *(OF_NODE[node] for node in nodes)])):
        return
    message = f"semmap up: missing optional packages; install: {_install(lacking)}"
    if not named and all(extra in _OPTIONS for extra in lacking):
        message += f", or start without: semmap up {' '.join(_OPTIONS[extra] for extra in lacking)}"
    raise errors.BadRequest(message)


def _install(extras: list[str]) -> str:
    return f"pip install 'semmap[{','.join(extras)}]'"
