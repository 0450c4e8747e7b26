from tests.kb_node.home import chair, transaction


def test_a_checkpoint_waits_for_idle_time_up_to_a_limit(semantic_map, monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_EVERY", 2)
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_AT_LATEST", 3)
    due = []
    for i in range(3):
        semantic_map.commit(transaction(i, chair(f"chair{i}")))
        due.append((semantic_map.checkpoint_is_due(quiet=True), semantic_map.checkpoint_is_due(quiet=False)))
    assert due == [(False, False), (True, False), (True, True)]
    semantic_map.checkpoint()
    assert not semantic_map.checkpoint_is_due(quiet=True)


def test_a_checkpoint_is_due_after_many_triples_when_idle(semantic_map, monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_EVERY_TRIPLES", 10)
    semantic_map.commit(transaction(1, chair("chair1")))
    assert not semantic_map.checkpoint_is_due(quiet=True)
    semantic_map.commit(transaction(2, chair("chair2")))
    assert semantic_map.checkpoint_is_due(quiet=True)
    assert not semantic_map.checkpoint_is_due(quiet=False)
    semantic_map.checkpoint()
    assert not semantic_map.checkpoint_is_due(quiet=True)
