"""The history of individuals that are not in space."""

import pytest

from semmap.nodes.kb_node.answers.past.individual_history import TripleChanges, find_changes, list_commits
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import History
from semmap.schemas.commits import Edit
from tests.kb_node.home import new_household_journal, transaction, turtle

ACME = "<http://example.org/org#acme>"


def of_acme(text):
    return turtle(f"{ACME} {text} .")


@pytest.fixture(scope="module")
def ask(tmp_path_factory):
    """Commits: 1 added, 2 another individual, 3 changed, 4 renamed, 5 removed again, with a chair."""
    journal = new_household_journal(tmp_path_factory.mktemp("map"))
    semantic_map = SemanticMap(journal)
    semantic_map.commit(transaction(1, of_acme("a <urn:Supplier> ; rdfs:label 'Acme'  ; <urn:rating> 3")))
    semantic_map.commit(transaction(2, turtle(f"<urn:x:bosch> a <urn:Supplier> ; <urn:of> {ACME} .")))
    semantic_map.commit(transaction(3, of_acme("<urn:rating> 4"), of_acme("<urn:rating> 3")))
    semantic_map.commit(transaction(4, verb="rename", edit=(Edit(name=ACME, rename="apex"),)))
    semantic_map.commit(transaction(5, remove=("bosch",)))

    def find(word, **fields):
        term = semantic_map.individuals.find_term(word)
        query = History(name=word, **fields)
        found = list_commits(journal, HistoryReader(journal), query, Thresholds(), term)
        return [(commit.seq, [change.text for change in commit.changes]) for commit in found]

    yield find
    journal.close()


def test_the_commits_of_an_individual_are_listed_under_its_earlier_names(ask):
    assert ask("apex") == [
        (1, ["added as Supplier"]),
        (3, ["rating: 3 → 4"]),
        (4, ["renamed from acme"]),
    ]
    assert ask("<http://example.org/org#apex>", limit=1) == [(4, ["renamed from acme"])]
    assert ask("apex", until="2") == [(1, ["added as Supplier"])]


def test_a_removed_individual_is_found_by_its_name(ask):
    assert ask("bosch") == [
        (2, ["added as Supplier"]),
        (4, ["of: acme → apex"]),
        (5, ["removed"]),
    ]


def test_a_name_that_no_individual_had_is_unknown(ask):
    with pytest.raises(errors.UnknownName, match="no entity was ever named 'carla'"):
        ask("carla")


def test_triples_before_the_history_are_known():
    first = of_acme("a <urn:Supplier> ; <urn:site> [] ; <urn:rating> 3 , 4")
    gone = [TripleChanges(seq=9, retracted=of_acme("<urn:rating> 4"), inserted=of_acme("a <urn:Firm>"))]
    (changes,) = find_changes(gone, first, "acme").values()
    assert {(change.property_, change.was, change.now) for change in changes} == {
        ("type", "Supplier", ("Firm", "Supplier")),
        ("rating", (3, 4), 3),
    }
    assert v.own_name(ACME) == "acme"
