"""Tables of arrays with one row per sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Table:
    """A dataclass whose fields are arrays of one length."""

    def __len__(self) -> int:
        return len(getattr(self, fields(self)[0].name))

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.int64]) -> Self:
        return type(self)(*(getattr(self, field.name)[rows] for field in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Join the rows of all parts, at least one."""
        return cls(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(cls)))

    def write(self, path: Path) -> None:
        """Write the table to a file atomically."""
        beside = path.with_name(f"{path.stem}.partly.npz")
        np.savez(beside, **{field.name: getattr(self, field.name) for field in fields(self)})
        beside.replace(path)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read the table from a file."""
        with np.load(path) as arrays:
            return cls(*(arrays[field.name] for field in fields(cls)))
