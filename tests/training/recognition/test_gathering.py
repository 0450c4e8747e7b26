import numpy as np

from nodes.training.recognition import gathering
from nodes.training.recognition.gathering import gather, joined, read, write


def test_what_is_gathered_is_the_same_each_time_and_out_of_its_file(tmp_path):
    gathered = gather(scenes=2, heaped=1, seed=5)
    assert set(gathered.things.scene.tolist()) == {0, 1}
    assert gathered.pairs.one.any()
    assert not gathered.pairs.one.all()
    write(gathered, tmp_path / "gathered.npz")
    again = joined([gathering._things(2, 5, None)], [gathering._pairs(1, 5 + gathering._SEEDS, None)])
    for found in (again, read(tmp_path / "gathered.npz")):
        np.testing.assert_array_equal(found.things.geometry, gathered.things.geometry)
        np.testing.assert_array_equal(found.pairs.known, gathered.pairs.known)
