"""The parts of a relation that the table of relations cannot derive."""

from pathlib import Path
from typing import get_args

import pytest

from semmap.nodes.kb_node.relations.facts.rules import RULES
from semmap.nodes.kb_node.relations.measuring.relation_table import MIRRORED, ONE_WAY, PAIR_RELATIONS
from semmap.nodes.language.lexicon import describing
from semmap.schemas.relations import RELATIONS, RelationName

ROOT = Path(__file__).parents[3]
TBOX = (ROOT / "ontology/household.ttl").read_text()
DEFINITIONS = [
    line.split("|")[1] for line in (ROOT / "docs/relations.md").read_text().splitlines() if "| " in line
]
STORED = {name for rule in RULES for name in rule.relations}
WITHOUT_WORDS = {"isLocatedIn", "isAttachedTo", "isVisibleFrom"}
"""Descriptions use the words of `isInside` and `isOn`, or none."""


def find_missing(row):
    """Return what a relation lacks, one sentence each."""
    missing = []
    if row.name not in WITHOUT_WORDS:
        missing += [f"words in {name}" for name in describing.LANGUAGES if not getattr(row, name)]
    start = TBOX.find(f"\ndm:{row.name} a owl:ObjectProperty")
    statement = TBOX[start : TBOX.find(" .\n", start)] if start >= 0 else ""
    if row.kind in ("stored", "on demand"):
        if not statement:
            missing.append("property in ontology/household.ttl")
        elif '"@en' not in statement or '"@it' not in statement:
            missing.append("labels in both languages in ontology/household.ttl")
        elif (row.inverse == row.name) != ("owl:SymmetricProperty" in statement):
            missing.append("the same symmetry in ontology/household.ttl")
    if (row.kind == "stored") != (row.name in STORED):
        missing.append("rule in nodes/kb_node/relations/facts/rules.py")
    if (row.kind == "on demand") != (row.name in PAIR_RELATIONS):
        missing.append("functions in nodes/kb_node/relations/measuring/relation_table.py")
    if not any(f"`{row.name}`" in definition for definition in DEFINITIONS):
        missing.append("row in docs/relations.md")
    return missing


@pytest.mark.parametrize("row", RELATIONS, ids=[row.name for row in RELATIONS])
def test_every_relation_is_complete(row):
    assert not find_missing(row)


def test_an_incomplete_relation_is_reported():
    missing = find_missing(RELATIONS[4]._replace(name="isTiedTo", inverse="isTiedTo", italian=()))
    assert len(missing) == 4
    assert "words in italian" in missing
    assert "property in ontology/household.ttl" in missing
    assert "row in docs/relations.md" in missing


def test_the_table_and_the_messages_have_the_same_relations():
    assert [row.name for row in RELATIONS] == list(get_args(RelationName))


def test_inverses_are_mutual_and_the_rest_is_one_way():
    assert all(MIRRORED[inverse] == name for name, inverse in MIRRORED.items())
    assert MIRRORED["isUnder"] == "isAbove"
    assert MIRRORED["touches"] == "touches"
    assert {"isLeaningAgainst"} == ONE_WAY
    assert MIRRORED.keys() | ONE_WAY == PAIR_RELATIONS.keys()
