import pytest

from semmap.nodes.kb_node.documents.load_parts import commit_each, split
from semmap.schemas import errors
from tests.kb_node.home import chair, close, new_map, transaction

CHAIRS = [chair(f"chair{i}") for i in range(10)]
LOAD = transaction("load", [triple for star in CHAIRS for triple in star], reason="load chairs.nt")


@pytest.fixture
def semantic_map(tmp_path):
    semantic_map = new_map(tmp_path)
    yield semantic_map
    close(semantic_map)


@pytest.mark.parametrize("size", [1, 4, 7, 20, 10_000])
def test_parts_contain_everything_and_do_not_split_entities(size):
    parts = split(LOAD, size)
    assert [triple for part in parts for triple in part.insert] == list(LOAD.insert)
    for part in parts:
        assert len(part.insert) % len(CHAIRS[0]) == 0
        assert part.insert[0] in [star[0] for star in CHAIRS]
    assert parts[-1].id == "load"
    assert len({part.id for part in parts}) == len(parts)


def test_an_empty_load_has_no_parts():
    assert split(transaction("load")) == []


def test_replaced_triples_are_removed_by_the_part_that_describes_their_individual():
    replaced = {star[0][0]: [("old", "p", star[0][0])] for star in CHAIRS} | {
        "elsewhere": [("old", "p", "o")]
    }
    parts = split(LOAD, 20, replaced)
    assert len(parts) > 2
    for part in parts[:-1]:
        assert {o for _, _, o in part.retract} == {star[0][0] for star in CHAIRS} & {
            s for s, _, _ in part.insert
        }
    removed = [triple for part in parts for triple in part.retract]
    assert sorted(removed) == sorted(triple for triples in replaced.values() for triple in triples)


def test_each_part_is_a_commit(semantic_map):
    told = []
    made = commit_each(split(LOAD, 20), semantic_map.commit, told.append)
    assert [commit.seq for commit in made] == list(range(1, len(made) + 1))
    assert len(semantic_map) == 10
    assert told[-1] == f"part {len(made)} of {len(made)}"
    assert made[0].reason == f"load chairs.nt, part 1 of {len(made)}"


def test_completed_parts_are_not_repeated(semantic_map):
    parts = split(LOAD, 20)
    first = [semantic_map.commit(part) for part in parts[:2]]
    made = commit_each(parts, semantic_map.commit, lambda _: None)
    assert made[:2] == first
    assert semantic_map.seq == len(made)


def test_the_error_of_a_part_reports_the_completed_parts(semantic_map):
    wrong = (CHAIRS[5][0][0], CHAIRS[5][0][1], CHAIRS[5][0][2].replace("Chair", "Kitchen"))
    parts = split(transaction("load", [*LOAD.insert[: 6 * len(CHAIRS[0])], wrong]), 2 * len(CHAIRS[0]))
    with pytest.raises(errors.Inconsistent, match=r"part 3 of 3: .* \(commits 1 to 2\), the rest is not"):
        commit_each(parts, semantic_map.commit, lambda _: None)
    assert len(semantic_map) == 4


def test_the_error_of_the_first_part_reports_no_completed_parts(semantic_map):
    wrong = (CHAIRS[0][0][0], CHAIRS[0][0][1], CHAIRS[0][0][2].replace("Chair", "Kitchen"))
    with pytest.raises(errors.Inconsistent) as refused:
        commit_each(split(transaction("load", [*CHAIRS[0], wrong])), semantic_map.commit, lambda _: None)
    assert "part" not in refused.value.text.split("cannot")[0]
    assert len(semantic_map) == 0
