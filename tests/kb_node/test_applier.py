import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import chair, state, transaction, turtle


def _worked_on(folder):
    """Return the state of a map after a large change, and the number of heartbeats."""
    folder.mkdir()
    beats = []
    created = home.new_map(folder)
    path = created._journal.path
    home.close(created)
    semantic_map = SemanticMap(Journal(path), progress=lambda: beats.append(1))
    many = [triple for i in range(9) for triple in chair(f"chair{i}", (i, 2.0, 0.0), preferred="chair")]
    semantic_map.commit(transaction(1, many))
    before = state(semantic_map)
    wrong = [*chair("chair10"), *turtle(":chair1 a dm:Kitchen ."), *chair("chair11")]
    with pytest.raises(errors.Inconsistent) as refusal:
        semantic_map.commit(transaction(2, wrong, chair("chair2", preferred="chair")[:2]))
    assert state(semantic_map) == before
    semantic_map.commit(transaction(3, turtle(":kitchen1 a dm:Kitchen ."), many[: len(many) // 2 + 2]))
    semantic_map.commit(transaction(4, many))
    count = len(beats)
    semantic_map.checkpoint()
    again = home.reopened(semantic_map)
    assert state(again) == state(semantic_map)
    home.close(again)
    return refusal.value.text, state(again)[1], count


def test_a_large_change_in_parts_gives_the_same_result(tmp_path, monkeypatch):
    *whole, beats = _worked_on(tmp_path / "whole")
    monkeypatch.setattr("semmap.nodes.kb_node.applier.PART", 7)
    *in_parts, more_beats = _worked_on(tmp_path / "parts")
    assert in_parts == whole
    assert more_beats > beats + 20
