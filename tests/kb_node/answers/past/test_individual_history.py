"""The history of individuals that are not in space."""

import pytest

from semmap.nodes.kb_node.answers.past.individual_history import (
    TripleChanges,
    find_changes,
    find_rename,
    list_commits,
)
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
        individuals = semantic_map.individuals
        term = individuals.find_term(word) or individuals.parse_iri(word)
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


@pytest.mark.parametrize("word", ["bosch", "urn:x:bosch", "<urn:x:bosch>"])
def test_a_removed_individual_is_found_by_its_name_or_iri(ask, word):
    assert ask(word) == [
        (2, ["added as Supplier"]),
        (4, ["of: acme → apex"]),
        (5, ["removed"]),
    ]


def test_an_individual_is_found_by_its_earlier_iri(ask):
    assert ask("<http://example.org/org#acme>") == [
        (1, ["added as Supplier"]),
        (3, ["rating: 3 → 4"]),
        (4, ["removed"]),
    ]


@pytest.mark.parametrize("word", ["carla", "<urn:x:carla>"])
def test_a_name_that_no_individual_had_is_unknown(ask, word):
    with pytest.raises(errors.UnknownName, match=f"no entity was ever named '{word}'"):
        ask(word)


@pytest.mark.parametrize(
    ("retracted", "inserted", "found"),
    [
        (":zed a dm:P ; dm:knows :zed .", ":zoe a dm:P ; dm:knows :zoe .", True),
        (":zed dm:knows :bob . :bob dm:knows :zed .", ":zoe dm:knows :bob . :bob dm:knows :zoe .", True),
        (":zed a dm:P .", ":zoe a dm:P . :ann a dm:P .", False),
        (":zed a dm:P .", ":zoe a dm:Q .", False),
    ],
)
def test_one_individual_with_the_same_statements_under_another_iri_is_renamed(retracted, inserted, found):
    names = v.iri(f"{v.ABOX}zed"), v.iri(f"{v.ABOX}zoe")
    assert find_rename(turtle(retracted), turtle(inserted)) == (names if found else None)


def test_an_undone_rename_of_one_that_refers_to_itself_is_followed(tmp_path):
    journal = new_household_journal(tmp_path)
    semantic_map = SemanticMap(journal)
    semantic_map.commit(transaction(1, of_acme(f"a <urn:Supplier> ; <urn:owns> {ACME}")))
    semantic_map.commit(transaction(2, verb="rename", edit=(Edit(name=ACME, rename="apex"),)))
    renaming = journal.commit(2)
    undone = transaction(3, renaming.retracted, renaming.inserted, verb="undo", undoes=(2,))
    semantic_map.commit(undone)
    found = list_commits(
        journal,
        HistoryReader(journal),
        History(name="acme"),
        Thresholds(),
        semantic_map.individuals.find_term("acme"),
    )
    journal.close()
    assert [(commit.seq, [change.text for change in commit.changes]) for commit in found] == [
        (1, ["added as Supplier"]),
        (2, ["renamed from acme", "owns: acme → apex"]),
        (3, ["renamed from apex", "owns: apex → acme"]),
    ]


def test_triples_before_the_history_are_known():
    first = of_acme("a <urn:Supplier> ; <urn:site> [] ; <urn:rating> 3 , 4")
    gone = [TripleChanges(seq=9, retracted=of_acme("<urn:rating> 4"), inserted=of_acme("a <urn:Firm>"))]
    (changes,) = find_changes(gone, first, "acme").values()
    assert {(change.property_, change.was, change.now) for change in changes} == {
        ("type", "Supplier", ("Firm", "Supplier")),
        ("rating", (3, 4), 3),
    }
    assert v.own_name(ACME) == "acme"
