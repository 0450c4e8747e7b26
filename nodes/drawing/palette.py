"""A colour for each class, the same in all recordings and on the page, and bright on a dark background."""

from __future__ import annotations

import math
import zlib
from functools import cache

Rgb = tuple[int, int, int]

GREY: Rgb = (150, 152, 156)
_CHROMA = 0.115
_LIGHTNESS = (0.68, 0.75, 0.82)


@cache
def colour_of(class_name: str) -> Rgb:
    """Return the colour of a class as 8-bit sRGB: hue and one of three shades from a hash of its name."""
    digest = zlib.crc32(class_name.encode())
    hue_rad = 2.0 * math.pi * (digest >> 8) / (1 << 24)
    return _srgb_from_oklch(_LIGHTNESS[digest % len(_LIGHTNESS)], _CHROMA, hue_rad)


def _srgb_from_oklch(lightness: float, chroma: float, hue_rad: float) -> Rgb:
    """Convert Oklch to sRGB. Oklab is perceptually uniform, so no hue stands out."""
    a, b = chroma * math.cos(hue_rad), chroma * math.sin(hue_rad)
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    return (
        _encoded(4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short),
        _encoded(-1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short),
        _encoded(-0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short),
    )


def _encoded(linear: float) -> int:
    clipped = min(1.0, max(0.0, linear))
    value = 12.92 * clipped if clipped <= 0.0031308 else 1.055 * clipped ** (1.0 / 2.4) - 0.055
    return round(255.0 * value)
