"""Commands on individuals that are not in space change a real map, without Zenoh."""

import pytest

from semmap.ontology import vocabulary as v
from semmap.schemas import commands as c
from semmap.schemas import errors
from tests.kb_node.home import transaction, turtle

ANNA = "http://example.org/people/anna"


@pytest.fixture
def people(dispatcher, semantic_map):
    """The dispatcher of a map with `chair1`, `anna` and `bob`."""
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(0.0, 0.0, 0.0), ref="seat"))
    persons = turtle(f"<{ANNA}> a <urn:Person> . <urn:x:bob> a <urn:Person> .")
    semantic_map.commit(transaction("people", persons))
    dispatcher.map.begin(semantic_map.snapshot())
    return dispatcher


@pytest.mark.parametrize("name", ["anna", ANNA, f"<{ANNA}>"])
def test_a_property_is_set_and_unset_by_name_or_iri(people, semantic_map, name):
    made = people.change(c.Set(name=name, property="isOpen", values=(True,)))
    assert (made.text, made.names, made.commit) == ("anna: isOpen: not set → true", ("anna",), 3)
    again = people.change(c.Set(name=name, property="isOpen", values=(True,)))
    assert (again.text, again.commit) == ("anna: unchanged: already up to date", None)
    people.change(c.Unset(name=name, property="isOpen"))
    assert semantic_map.described("anna").properties == {}


@pytest.mark.parametrize("word", ["seat", "Chair", "the chair"])
def test_a_property_is_set_by_the_label_or_class_of_only_one_thing(people, word):
    made = people.change(c.Set(name=word, property="isOpen", values=(True,)))
    assert (made.text, made.names) == ("chair1: isOpen: not set → true", ("chair1",))
    people.change(c.Add(class_="Chair", at=(3.0, 0.0, 0.0), ref="seat"))
    with pytest.raises(errors.BadRequest, match="is ambiguous: chair1 and chair2; name one of them"):
        people.change(c.Unset(name=word, property="isOpen"))


@pytest.mark.parametrize(
    "command",
    [c.Remove(names=("Author",)), c.Rename(name="the poet", new="x"), c.Update(name="poet", ref="x")],
)
def test_an_individual_is_not_removed_renamed_or_updated_by_its_class_or_label(people, semantic_map, command):
    label = f"<{v.RDFS}label>"
    semantic_map.commit(transaction(3, turtle(f'<urn:x:dante> a <urn:Author> ; {label} "poet" .')))
    with pytest.raises(errors.UnknownName, match=r"no entity is named '(Author|the poet|poet)'"):
        people.change(command)


def test_an_entity_is_removed_once_by_its_name_and_iri(people):
    iri = people.map.entities["chair1"].iri
    made = people.change(c.Remove(names=(iri, "chair1", f"<{iri}>")))
    assert (made.text, made.names) == ("removed 1: chair1", ("chair1",))


def test_the_name_of_an_individual_precedes_labels_of_entities(people):
    people.change(c.Update(name="chair1", ref="anna"))
    made = people.change(c.Set(name="anna", property="isOpen", values=(True,)))
    assert made.text == "anna: isOpen: not set → true"
    assert people.change(c.Remove(names=("anna",))).text == "removed 1: anna"


def test_a_dry_run_changes_nothing_and_says_what_would_change(people, semantic_map):
    tried = people.change(c.Set(name="anna", property="isOpen", values=(True,), dry_run=True))
    assert (tried.commit, tried.dry_run) == (None, True)
    assert tried.text.endswith("it would be: anna: set anna isOpen true")
    assert semantic_map.seq == 2


def test_an_individual_is_gone_after_its_last_value_is_unset(people, semantic_map):
    semantic_map.commit(transaction(3, turtle("<urn:x:carla> dm:isOpen true .")))
    made = people.change(c.Unset(name="carla", property="isOpen"))
    assert made.text == "carla: unset carla isOpen"


def test_individuals_and_entities_are_removed_together_or_not_at_all(people, semantic_map):
    with pytest.raises(errors.UnknownName, match="no entity is named 'dora'"):
        people.change(c.Remove(names=("anna", "dora")))
    with pytest.raises(errors.Refused, match="anna was defined by an operator"):
        people.change(c.Remove(names=("anna",), source="perception"))
    made = people.change(c.Remove(names=("anna", "chair1", "urn:x:bob")))
    assert made.text == "removed 3: anna, chair1 and bob"
    assert semantic_map.abox() == []


def test_a_property_that_only_the_map_uses_is_not_set(people, semantic_map):
    semantic_map.commit(transaction(3, turtle("<urn:x:bob> <urn:x#rating> 3 .")))
    with pytest.raises(errors.BadRequest, match="'rating' is not part of the TBox, only of the map; to decl"):
        people.change(c.Set(name="bob", property="rating", values=(4,)))
    with pytest.raises(errors.BadRequest, match="unknown property 'ratings'"):
        people.change(c.Set(name="bob", property="ratings", values=(4,)))
    with pytest.raises(errors.BadRequest, match="changed with: semmap update"):
        people.change(c.Set(name="chair1", property="hasPosition", values=("x",)))


def test_class_labels_and_properties_are_updated(people, semantic_map):
    made = people.change(
        c.Update(name="anna", class_="Property", ref="Anna", alt=("A.",), set=("isOpen=true",))
    )
    assert made.text.startswith("anna: ")
    now = semantic_map.described("anna")
    assert (now.class_, now.preferred_reference, now.alternative_references) == ("Property", "Anna", ("A.",))
    assert now.properties["isOpen"] is True
    again = people.change(c.Update(name=ANNA, ref="Anna"))
    assert (again.text, again.commit) == ("anna: unchanged: already up to date", None)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"at": (0.0, 0.0, 0.0), "next_to": "chair1"}, "properties can be updated; remove --at --next-to"),
        ({"class_": "Chair"}, "Chair is a class of things in space; for a new entity of it: semmap add"),
        ({"ref": "x", "source": "perception"}, "anna was defined by an operator"),
    ],
)
def test_an_update_gives_an_individual_no_place(people, fields, message):
    with pytest.raises(errors.Refused, match=message):
        people.change(c.Update(name="anna", **fields))


def test_a_batch_does_not_change_an_individual(people):
    opened = c.Set(name="anna", property="isOpen", values=(True,))
    with pytest.raises(errors.Refused, match="a batch changes only entities; use: semmap set anna"):
        people.change(c.Batch(changes=(opened,)))


def test_an_entity_is_updated_by_its_iri(people, semantic_map):
    people.change(c.Update(name=semantic_map.entity("chair1").iri, ref="stool"))
    assert semantic_map.entity("chair1").preferred_reference == "stool"


def test_an_individual_is_renamed_with_what_refers_to_it(people, semantic_map):
    semantic_map.commit(transaction(3, turtle(f"<urn:x:bob> <urn:knows> <{ANNA}> .")))
    made = people.change(c.Rename(name="anna", new="anne"))
    assert (made.text, made.names) == ("renamed anna to anne", ("anne",))
    assert semantic_map.described("anne").iri == "http://example.org/people/anne"
    assert semantic_map.described("bob").properties == {"knows": ("anne",)}
    for taken in ("bob", "chair1"):
        with pytest.raises(errors.NameTaken, match=f"the name '{taken}' is taken"):
            people.change(c.Rename(name="anne", new=taken))
    semantic_map.commit(transaction(4, turtle("<urn:x:twin> a <urn:P> . <urn:y:twin> a <urn:P> .")))
    with pytest.raises(errors.NameTaken, match="several individuals have the name 'twin'; give another name"):
        people.change(c.Rename(name="anne", new="twin"))
    with pytest.raises(errors.Refused, match="anne was defined by an operator"):
        people.change(c.Rename(name="anne", new="anna", source="perception"))


def test_an_entity_to_update_is_also_given_by_its_iri_but_not_by_its_label(people, semantic_map):
    iri = semantic_map.entity("chair1").iri
    people.change(c.Set(name=iri, property="isOpen", values=(True,)))
    assert semantic_map.entity("chair1").properties == {"isOpen": True}
    for word in ("seat", "chair2"):
        with pytest.raises(errors.UnknownName, match=f"no entity is named '{word}'"):
            people.change(c.Update(name=word, set=("isOpen=false",)))
    people.change(c.Remove(names=(f"<{iri}>",)))
    assert "chair1" not in semantic_map.by_name
