"""LZF, as in PCD files."""

from __future__ import annotations

import pytest

from semmap.nodes.perception_node.input.files import lzf


def test_literals():
    assert lzf.decompress(bytes([4]) + b"abcde", 5) == b"abcde"


def test_a_reference_back():
    # "abcd", then 3 bytes from 4 back
    assert lzf.decompress(bytes([3]) + b"abcd" + bytes([1 << 5, 3]), 7) == b"abcdabc"


def test_a_reference_that_repeats_itself():
    assert lzf.decompress(bytes([0]) + b"a" + bytes([3 << 5, 0]), 6) == b"aaaaaa"


def test_a_long_reference():
    # 7 in the control byte: 7 + 4 + 2 bytes
    assert lzf.decompress(bytes([1]) + b"ab" + bytes([7 << 5, 4, 1]), 15) == b"ab" * 7 + b"a"


@pytest.mark.parametrize(
    ("packed", "size"),
    [
        (bytes([3]) + b"abcd", 5),  # less than promised
        (bytes([3]) + b"abcd", 3),  # more than promised
        (bytes([0]) + b"a" + bytes([1 << 5, 9]), 4),  # before the beginning
        (bytes([0]) + b"a" + bytes([1 << 5]), 4),  # ends within a reference
    ],
)
def test_damaged_blocks_are_refused(packed, size):
    with pytest.raises(ValueError, match=r"."):
        lzf.decompress(packed, size)
