from semmap.nodes.kb_node.progress import split_batches, with_progress


def test_the_node_tells_that_it_lives_now_and_then():
    beats = []
    assert list(with_progress(range(2500), lambda: beats.append(1))) == list(range(2500))
    assert len(beats) == 2


def test_parts_are_the_whole():
    beats = []
    assert list(split_batches("abcde", 2, lambda: beats.append(1))) == [["a", "b"], ["c", "d"], ["e"]]
    assert len(beats) == 3
    assert list(split_batches((), 2, lambda: None)) == []
