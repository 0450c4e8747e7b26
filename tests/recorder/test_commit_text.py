from semmap.nodes.recorder import commit_text
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import PlaceChanges
from tests.recorder.messages import commit, entity, pose, relation


def test_a_line_says_who_and_why():
    made = commit(7, agent="ann", reason="add beer1", inserted=(relation("beer1", "isOn", "table1"),))
    assert commit_text.headline(made) == "7  operator ann: add beer1 (+1 -0)"


def test_without_a_reason_a_line_names_the_entities():
    made = commit(7, *(entity(f"cup{i}") for i in range(4)), removed=("beer1",))
    assert commit_text.headline(made) == "7  operator: cup0, cup1, cup2 and 2 more (+0 -0)"


def test_a_page_holds_everything():
    text = commit_text.page(
        commit(
            7,
            entity("beer1", "Beer", at=pose(1.0, 2.0, 0.75)),
            removed=("cup1",),
            reason="tidy up",
            confidence=0.5,
            inserted=((v.entity_iri("beer1"), v.LEXICAL_REFERENCE, '"a beer"'),),
            retracted=(relation("cup1", "isOn", "table1"),),
            notes=("on table1 was cup1",),
            places=PlaceChanges(
                came=(relation("beer1", "isOn", "table2"),),
                went=(relation("cup1", "isLocatedIn", "kitchen1"),),
            ),
        )
    )
    for words in (
        "# Commit 7",
        "**operator** · 2023-11-14 22:13:27 UTC · confidence 0.50",
        "tidy up",
        "**beer1**, a Beer at (1.00, 2.00, 0.75)",
        "**cup1** left the map",
        "> on table1 was cup1",
        "+ beer1 lexicalReference a beer",
        "- cup1 isOn table1",
        "**Measured** (1)",
        "+ beer1 isOn table2",
        "**No longer measured** (1)",
        "- cup1 isLocatedIn kitchen1",
        "`id-7`",
    ):
        assert words in text


def test_a_page_shows_a_renamed_entity_once():
    node = v.entity_iri("mug1_coordinates")
    text = commit_text.page(
        commit(
            7,
            entity("mug2", "Cup", at=pose(1.0, 2.0, 0.75)),
            removed=("mug1",),
            retracted=((v.entity_iri("mug1"), v.HAS_POSITION, node),),
            inserted=((v.entity_iri("mug2"), v.HAS_POSITION, node),),
        )
    )
    assert "- **mug2**, a Cup, renamed from **mug1**, at (1.00, 2.00, 0.75)" in text
    assert "left the map" not in text


def test_a_page_of_a_large_commit_stays_readable():
    triples = tuple(relation(f"cup{i}", "isOn", "table1") for i in range(1000))
    text = commit_text.page(commit(7, inserted=triples))
    assert text.count("\n") < 60
    assert "and 960 more" in text
