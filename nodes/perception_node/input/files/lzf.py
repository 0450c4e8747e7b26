"""LZF, the compression of PCD files."""

from __future__ import annotations


def decompress(packed: bytes, size: int) -> bytes:
    """Return the decompressed data of `size` bytes. Raises ValueError for a damaged or truncated block.

    A control byte below 32 announces that many literal bytes plus one. Any other is a back reference: its
    upper three bits are the length less two (7: the next byte is added), and the rest with the next byte is
    the distance less one. A reference may overlap its output, which repeats the data.
    """
    out = bytearray()
    here, end = 0, len(packed)
    try:
        while here < end:
            control = packed[here]
            here += 1
            if control < 32:
                out += packed[here : here + control + 1]
                here += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += packed[here]
                here += 1
            start = len(out) - ((control & 31) << 8) - packed[here] - 1
            here += 1
            length += 2
            if start < 0:
                raise ValueError("a reference to before the beginning")
            unit = out[start : start + length]
            while len(unit) < length:
                unit += unit[: length - len(unit)]
            out += unit
            if len(out) > size:
                raise ValueError(f"more than the {size} bytes promised")
    except IndexError:
        raise ValueError("truncated within a reference") from None
    if len(out) != size:
        raise ValueError(f"{len(out)} of the {size} bytes promised")
    return bytes(out)
