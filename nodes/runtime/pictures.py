"""Opens images of other people, with a limit on their pixels, which is checked before they are decoded.

Importing this module also limits the images that other libraries open with Pillow in this process, such as
the textures of meshes.
"""

from __future__ import annotations

import io
import struct
import warnings
from pathlib import Path
from typing import Final

from PIL import Image

MAX_PIXELS: Final = 50_000_000
_FORMATS: Final = ("PNG", "JPEG", "TIFF", "BMP", "PPM", "WEBP", "GIF")
"""Some of Pillow's other formats start other programs."""
_PNG: Final = b"\x89PNG\r\n\x1a\n"
_PNG_SIZE: Final = struct.Struct(">8x8x2I")
"""The size [pixel] at the start of a PNG file, after its mark and the start of its first chunk."""

Image.MAX_IMAGE_PIXELS = MAX_PIXELS // 2  # Pillow rejects more than twice this, and warns before
warnings.filterwarnings("ignore", category=Image.DecompressionBombWarning)


def open_picture(source: Path | bytes, most_pixels: int = MAX_PIXELS) -> Image.Image:
    """Open and decode an image, from a file or its content.

    Raises ValueError if it is invalid, truncated or has more than `most_pixels`, and OSError if the file
    cannot be read.
    """
    try:
        image = Image.open(io.BytesIO(source) if isinstance(source, bytes) else source, formats=_FORMATS)
        try:
            _require_size(image.width, image.height, most_pixels)
            image.load()
        except BaseException:
            image.close()
            raise
    except Image.DecompressionBombError:
        raise ValueError(f"the image has too many pixels; the maximum is {most_pixels:,}") from None
    except SyntaxError as error:
        raise ValueError(f"not an image: {error}") from None
    except OSError as error:
        if error.errno is not None:
            raise
        raise ValueError("not an image, or a truncated one") from None
    return image


def require_small_png(path: Path) -> None:
    """Raise ValueError for a PNG file of more than `MAX_PIXELS`, OSError if the file cannot be read.

    Other files are not checked.
    """
    with path.open("rb") as file:
        head = file.read(_PNG_SIZE.size)
    if head.startswith(_PNG) and len(head) == _PNG_SIZE.size:
        width, height = _PNG_SIZE.unpack(head)
        _require_size(width, height, MAX_PIXELS)


def _require_size(width: int, height: int, most_pixels: int) -> None:
    if width * height > most_pixels:
        raise ValueError(f"the image has {width} x {height} pixels; the maximum is {most_pixels:,} pixels")
