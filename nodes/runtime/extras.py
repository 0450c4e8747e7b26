"""The parts of semmap that extras install: `pip install 'semmap[sim]'`. Without any it is a client.

A verb or a node says which one it lacks, before it does anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.util import find_spec

from semmap.schemas import errors

MODULES: Mapping[str, tuple[str, ...]] = {
    "kb": (
        *("numpy", "owlrl", "psutil", "pycrfsuite", "pyhornedowl", "pyoxigraph", "rapidfuzz", "rdflib"),
        "supervisor",
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
"""What each extra installs, as it is imported."""

OF_NODE: Mapping[str, str] = {
    "router": "kb",
    "coordinator": "kb",
    "kb_node": "kb",
    "sim_node": "sim",
    "perception_node": "perception",
    "recorder": "record",
    "web": "web",
}
"""What a node, and the page beside them, needs."""

_OPTIONS = {"sim": "--no-sim", "record": "--no-record"}
"""How `semmap up` does without one."""


def missing(extras: Iterable[str]) -> list[str]:
    """Those of `extras` of which something is not installed."""
    return [extra for extra in dict.fromkeys(extras) if any(find_spec(m) is None for m in MODULES[extra])]


def require(what: str, *extras: str) -> None:
    """Raises BadRequest, with what to install, when `what` needs what is not installed."""
    if lacking := missing(extras):
        raise errors.BadRequest(f"{what} needs more than is installed: {_install(lacking)}")


def require_nodes(nodes: Iterable[str], *, named: bool = False) -> None:
    """The same for `semmap up` with these nodes; says how to do without them, too, where that is possible.

    It is not where they were `named`.
    """
    if not (lacking := missing(["kb", *(OF_NODE[node] for node in nodes)])):
        return
    said = f"semmap up needs more than is installed: {_install(lacking)}"
    if not named and all(extra in _OPTIONS for extra in lacking):
        said += f", or go without: semmap up {' '.join(_OPTIONS[extra] for extra in lacking)}"
    raise errors.BadRequest(said)


def _install(extras: list[str]) -> str:
    return f"pip install 'semmap[{','.join(extras)}]'"
