import numpy as np

from semmap.nodes.perception_node.image_features.crops import crops_of
from semmap.nodes.perception_node.image_features.efficientnet import SIDE

RED, BLUE = (200, 0, 0), (0, 0, 200)


def view(rows, columns, shape=(40, 60)):
    """A red thing before a blue background."""
    labels = np.zeros(shape, np.int32)
    labels[rows, columns] = 3
    return np.where(labels[..., None] == 3, np.uint8(RED), np.uint8(BLUE)), labels


def test_a_thing_fills_most_of_a_square_around_it():
    whole, alone = crops_of([view(slice(10, 30), slice(20, 30))], 3)
    assert whole.shape == alone.shape == (SIDE, SIDE, 3)
    middle, corner = SIDE // 2, 4
    assert tuple(whole[middle, middle]) == tuple(alone[middle, middle]) == RED
    assert (tuple(whole[corner, corner]), tuple(alone[corner, corner])) == (BLUE, (127, 127, 127))
    shares = (alone == RED).all(axis=2).mean(axis=0).max(), (alone == RED).all(axis=2).mean(axis=1).max()
    np.testing.assert_allclose(shares, (20 / 26, 10 / 26), atol=0.05)


def test_what_is_outside_of_the_image_is_grey():
    whole, _ = crops_of([view(slice(0, 20), slice(0, 20))], 3)
    assert tuple(whole[2, 2]) == (127, 127, 127)
    assert tuple(whole[-2, -2]) == BLUE


def test_the_view_that_shows_most_of_a_thing_is_used():
    few, many = view(slice(0, 5), slice(0, 5)), view(slice(10, 30), slice(20, 30))
    np.testing.assert_array_equal(crops_of([few, many], 3)[0], crops_of([many], 3)[0])


def test_an_unseen_thing_has_no_image():
    assert crops_of([view(slice(0, 5), slice(0, 5))], 1) is None
    assert crops_of([], 1) is None
