"""Start times of relations, compared with measuring the whole map after each commit."""

import random

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.past.fact_intervals import PoseChanges, find_fact_starts
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas import codec
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import Pose
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

FIRST = [ROOM, CORNER, TABLE, thing("table2", (1.7, 0.2, 0.0)), thing("bowl1", (0.0, -0.4, TOP))]
SPOTS = [(0.0, 0.0, TOP), (0.0, -0.4, TOP + 0.02), (1.7, 0.2, TOP), (2.0, 2.0, 0.0), (0.0, 0.0, TOP + 0.03)]


def random_commits(dice, count):
    there = {}
    for seq in range(1, count + 1):
        name = dice.choice(["cup1", "cup2", "book1", "apple1", "table2", "bowl1"])
        if name in there and name != "table2" and dice.random() < 0.2:
            del there[name]
            changed, removed = (), (Departed(name=name, types=()),)
        else:
            x, y, z = dice.choice([(1.7, 0.2, 0.0), (5.0, 0.2, 0.0)] if name == "table2" else SPOTS)
            there[name] = thing(name, (x + dice.choice((0.0, 0.03)), y, z))
            changed, removed = (there[name],), ()
        yield Commit(seq=seq, stamp_ns=seq, id=str(seq), source="file", changed=changed, removed=removed)


@pytest.mark.parametrize("seed", range(8))
def test_one_pass_agrees_with_measuring_the_whole_map_at_each_commit(seed):
    commits = list(random_commits(random.Random(seed), 60))
    facts, there = Facts(), {entity.name: entity for entity in FIRST}
    facts.update(FIRST)
    since = dict.fromkeys(facts, 0)
    for commit in commits:
        for left in commit.removed:
            there.pop(left.name, None)
        there.update((entity.name, entity) for entity in commit.changed)
        gone, come = facts.update(commit.changed, [left.name for left in commit.removed])
        for fact in gone:
            del since[fact]
        since.update(dict.fromkeys(come, commit.seq))
    outlines = [codec.decode(codec.encode(commit), PoseChanges) for commit in commits]
    assert find_fact_starts(outlines, FIRST, list(since), Thresholds()) == since
    assert len(set(since.values())) > 3


def test_a_fact_that_does_not_hold_has_no_start():
    cup = thing("cup1", (2.0, 2.0, 0.0))
    came = PoseChanges(seq=1, changed=codec.decode(codec.encode(commit_of(cup)), PoseChanges).changed)
    assert find_fact_starts([came], FIRST, [("cup1", "isOn", "table1")], Thresholds()) == {}
    on = structs.replace(cup, pose=Pose(position_m=(0.0, 0.0, TOP)))
    moved = PoseChanges(seq=2, changed=codec.decode(codec.encode(commit_of(on)), PoseChanges).changed)
    fact = ("cup1", "isOn", "table1")
    assert find_fact_starts([came, moved], FIRST, [fact], Thresholds()) == {fact: 2}
    assert find_fact_starts([moved, came], FIRST, [fact], Thresholds()) == {}


def commit_of(entity):
    return Commit(seq=1, stamp_ns=1, id="1", source="file", changed=(entity,))
