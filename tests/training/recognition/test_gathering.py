import numpy as np
import pytest

from semmap.nodes.training.recognition import gathering
from semmap.nodes.training.recognition.gathering import gather, joined, read


@pytest.mark.long
def test_what_is_gathered_is_the_same_each_time_and_out_of_its_files(tmp_path):
    gathered = gather(scenes=2, heaped=1, ours=1, seed=11, keep=tmp_path)
    assert set(gathered.things.scene.tolist()) == {0, 1}
    assert gathered.pairs.one.any()
    assert not gathered.pairs.one.all()
    pairs = gathering._pairs(1, 11 + gathering._SEEDS, None, None)
    own = gathering._own(1, 11 + 2 * gathering._SEEDS, None)
    again = joined([gathering._things(2, 11, None, None)], [own], [pairs])
    for found in (again, read(tmp_path)):
        np.testing.assert_array_equal(found.things.geometry, gathered.things.geometry)
        np.testing.assert_array_equal(found.pairs.known, gathered.pairs.known)
        np.testing.assert_array_equal(found.own.geometry, gathered.own.geometry)


def test_parts_that_are_there_are_not_made_again(tmp_path):
    made = gathering._pairs(1, 2, None, tmp_path)
    (kept,) = tmp_path.iterdir()
    made[made.one].write(kept)
    assert gathering._pairs(1, 2, None, tmp_path).one.all()
