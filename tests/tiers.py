"""Which tests need real processes.

A test that starts a process or opens a Zenoh session, itself or by a fixture, is marked `process`: the names
that its code mentions show it. Any other test fails as soon as it starts a process.
"""

from __future__ import annotations

import functools
import os
import sys
import types
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

STARTERS = frozenset(
    {
        *("subprocess.Popen", "subprocess.run", "subprocess.check_output", "posix.fork", "zenoh.zenoh.open"),
        "multiprocessing.context.DefaultContext.get_context",
        *("semmap.nodes.bus.session.open_session", "semmap.nodes.extern.connection.open_session"),
        *("semmap.nodes.extern.client.connect", "semmap.nodes.extern.async_client.connect"),
        *("semmap.nodes.extern.testing.own_system", "semmap.nodes.supervisor.control.Supervisor"),
        *("semmap.nodes.kb_node.sparql.service.SparqlService", "semmap.nodes.kb_node.sparql.worker.Worker"),
        *(
            "semmap.nodes.kb_node.answers.past.past_map.query_past",
            "semmap.nodes.kb_node.answers.answers.check",
        ),
        *(
            "semmap.nodes.kb_node.owlrl.consistency_check.find_owlrl_faults",
            "semmap.nodes.kb_node.relations.facts.precomputation.Precomputation",
        ),
    }
)
"""Functions and classes that start a process or open a session, where they are defined."""

_AUDITED = frozenset({"subprocess.Popen", "os.fork", "os.posix_spawn"})
_STDLIB = Path(os.__file__).parent
_is_pure = False
"""Whether the test that runs is one that needs no process."""


def needs_process(item: pytest.Item) -> bool:
    """Return whether a test, or a fixture that it uses, starts a process or opens a session."""
    if not isinstance(item, pytest.Function):
        return False
    fixtures = {found.func for several in item._fixtureinfo.name2fixturedefs.values() for found in several}
    return _is_starter(item.function, frozenset(fixtures))


@functools.cache
def _is_starter(test: Callable[..., Any], fixtures: frozenset[Callable[..., Any]]) -> bool:
    """Return whether a test or one of its fixtures starts a process; kept for its other parameters."""
    return uses_any([test, *fixtures], STARTERS)


def uses_any(functions: Iterable[Callable[..., Any]], names: frozenset[str]) -> bool:
    """Return whether these mention one of the functions with these names.

    What they use of `tests` and `benchmarks` is looked into, too.
    """
    seen: set[int] = set()
    waiting: list[Any] = [*functions]
    while waiting:
        found = waiting.pop()
        if id(found) in seen:
            continue
        seen.add(id(found))
        for used in _mentioned(found):  # most are asked for again, by other tests
            if _name(used) in names:
                return True
            if callable(used) and _module(used).startswith(("tests.", "benchmarks.")):
                waiting.append(used)
    return False


def forbid_processes() -> None:
    """From now on, a test that is not marked `process` fails when it starts a process."""
    sys.addaudithook(_check)


def watch(item: pytest.Item | None) -> None:
    """Note which test runs from now on; None: none does."""
    global _is_pure
    _is_pure = item is not None and item.get_closest_marker("process") is None


def _check(event: str, _: tuple[Any, ...]) -> None:
    if _is_pure and event in _AUDITED and _is_ours(sys._getframe(1)):
        raise RuntimeError("this test is not marked `process`: add what starts the process to tests/tiers.py")


def _is_ours(frame: types.FrameType | None) -> bool:
    """Whether our code asked Python's library for a process; what other libraries start is short."""
    while frame is not None and Path(frame.f_code.co_filename).is_relative_to(_STDLIB):
        if "site-packages" in frame.f_code.co_filename:
            return False
        frame = frame.f_back
    return frame is not None and "site-packages" not in frame.f_code.co_filename


@functools.cache
def _mentioned(found: Any) -> tuple[Any, ...]:
    """The global objects that a function, or a class in its methods, mentions; also as `module.name`."""
    return tuple(used for function in _functions(found) for used in _mentioned_in(function))


def _mentioned_in(function: types.FunctionType) -> Iterator[Any]:
    names = {*_names(function.__code__)}
    for name in names & function.__globals__.keys():
        found = function.__globals__[name]
        yield found
        if isinstance(found, types.ModuleType):
            # What `semmap` has is imported when it is first used, so its `vars` do not show it.
            yield from (getattr(found, inner) for inner in names & {*dir(found)})


def _functions(found: Any) -> Iterator[types.FunctionType]:
    """A function itself, without decorators; of a class, its methods."""
    if isinstance(found, type):
        for member in vars(found).values():
            if not isinstance(member, type):
                yield from _functions(getattr(member, "fget", None) or member)
        return
    while inner := getattr(found, "__wrapped__", None) or getattr(found, "__func__", None):
        found = inner
    if isinstance(found, types.FunctionType):
        yield found


def _names(code: types.CodeType) -> Iterator[str]:
    """All names in a function, and in those that it defines."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _names(constant)


def _name(found: Any) -> str:
    return f"{_module(found)}.{getattr(found, '__qualname__', '')}"


def _module(found: Any) -> str:
    return str(getattr(found, "__module__", ""))
