"""The formats of SPARQL results."""

from __future__ import annotations

from typing import Literal, get_args

Format = Literal["table", "json", "csv", "turtle"]
FORMATS: tuple[Format, ...] = get_args(Format)
