import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.mask_files import read_masks
from semmap.schemas.errors import BadFile

IMAGE = '<annotations><image id="0" name="rgb.png" width="{}" height="{}">{}</image>{}</annotations>'


def masks_of(tmp_path, shapes, more="", size=(6, 4)):
    (tmp_path / "masks.xml").write_text(IMAGE.format(*size, shapes, more))
    return read_masks(tmp_path / "masks.xml", 4, 6)


def test_polygons_boxes_and_run_lengths_are_masks(tmp_path):
    found = masks_of(
        tmp_path,
        '<polygon label="cup" points="0.0,0.0;2.0,0.0;2.0,2.0;0.0,2.0"/>'
        '<box label="plate" xtl="3" ytl="0" xbr="6" ybr="1"/>'
        '<mask label="power drill" rle="1, 2, 1, 2" left="2" top="2" width="3" height="2"/>'
        '<tag label="kitchen"/>',
    )
    expected = [[1, 1, 0, 2, 2, 2], [1, 1, 0, 0, 0, 0], [0, 0, 0, 3, 3, 0], [0, 0, 0, 3, 3, 0]]
    np.testing.assert_array_equal(found.labels, expected)
    assert [(one.label, one.score) for one in found.detector_labels] == [
        ("cup", 1.0),
        ("plate", 1.0),
        ("power drill", 1.0),
    ]


def test_a_box_may_be_turned_around_its_middle(tmp_path):
    pen = '<box label="pen" xtl="0" ytl="2" xbr="4" ybr="4" rotation="90.00"/>'
    expected = np.zeros((4, 6), np.int32)
    expected[1:, 1:3] = 1  # x from 1 to 3, y from 1 to 5
    np.testing.assert_array_equal(masks_of(tmp_path, pen).labels, expected)


@pytest.mark.parametrize(
    ("shapes", "more", "said"),
    [
        ('<polygon label="cup" points="1,1;2"/>', "", "a polygon of 'cup' is invalid"),
        (
            '<mask label="cup" rle="1,2" left="0" top="0" width="2" height="2"/>',
            "",
            "its runs do not fill its box",
        ),
        ('<mask label="cup" rle="0" left="0" top="0" width="0" height="2"/>', "", "do not fill its box"),
        ('<mask label="cup" rle="4" left="5" top="0" width="2" height="2"/>', "", "the box leaves the image"),
        ('<box label="cup" xtl="1"/>', "", "a box of 'cup' is invalid"),
        ("<box", "", "not XML"),
        ("", "<track/>", "it has the tracks of a video"),
        ('<box xtl="0" ytl="0" xbr="1" ybr="1"/>', "<image><box/></image>", "it has masks of 2 images"),
    ],
)
def test_an_invalid_file_is_rejected_with_the_shape_that_is_wrong(tmp_path, shapes, more, said):
    with pytest.raises(BadFile, match=said):
        masks_of(tmp_path, shapes, more)


def test_masks_of_another_image_size_are_rejected(tmp_path):
    box = '<box xtl="0" ytl="0" xbr="1" ybr="1"/>'
    with pytest.raises(BadFile, match="for an image of 12 x 8 pixels, not 6 x 4"):
        masks_of(tmp_path, box, size=(12, 8))
