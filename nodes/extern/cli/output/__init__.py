"""Formatting of the output of the command line.

`output.show` and other modules are imported at first use: importing the libraries for tables takes as long as
most requests.
"""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from semmap.nodes.extern.cli.output import show as show
    from semmap.nodes.extern.cli.output import sparql_formats as sparql_formats
    from semmap.nodes.extern.cli.output import tables as tables

_LATE = {"show", "sparql_formats", "tables"}


def __getattr__(name: str) -> ModuleType:
    if name in _LATE:
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
