from semmap.nodes.kb_node.progress import split_batches, with_progress


def test_the_node_sends_heartbeats():
    beats = []
    assert list(with_progress(range(2500), lambda: beats.append(1))) == list(range(2500))
    assert len(beats) == 2


def test_batches_contain_everything():
    beats = []
    assert list(split_batches("abcde", 2, lambda: beats.append(1))) == [["a", "b"], ["c", "d"], ["e"]]
    assert len(beats) == 3
    assert list(split_batches((), 2, lambda: None)) == []
