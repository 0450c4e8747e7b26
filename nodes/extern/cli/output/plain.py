"""Tables as plain text, without colours and line wrapping."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.cells import cell_len

from semmap.nodes.extern.cli.output.printable import escaped

_BETWEEN = "  "


def lines(
    names: Sequence[str], rows: Iterable[Sequence[str]], to_the_right: Sequence[bool] = ()
) -> Iterator[str]:
    """Yield the header, and a line for each row."""
    shown = [[escaped(cell) for cell in row] for row in rows]
    widths = [max(map(cell_len, column)) for column in zip(names, *shown, strict=True)]
    right = to_the_right or [False] * len(names)

    def line(cells: Sequence[str]) -> str:
        spaces = [" " * (width - cell_len(cell)) for cell, width in zip(cells, widths, strict=True)]
        parts = [s + c if last else c + s for c, s, last in zip(cells, spaces, right, strict=True)]
        return _BETWEEN.join(parts).rstrip()

    yield line(names)
    yield from map(line, shown)
