"""Arrays of NumPy in files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def open_array(path: Path) -> NDArray[Any]:
    """Return the array in an .npy file, which is read only where it is used: its header may claim any size.

    Raises ValueError, with one line, for an invalid file, and OSError.
    """
    try:
        with np.errstate(over="ignore"):  # of the size, which is then larger than the file
            return np.lib.format.open_memmap(path, mode="r")
    except ValueError as error:
        raise ValueError(f"not a valid .npy array: {str(error).partition(chr(10))[0]}") from None
