from semmap.nodes.extern.web.views.suggested_fixes import suggest_fixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Add, Batch, Remove, Set, Unset, Update
from semmap.schemas.explanations import Explanation
from tests.extern.web.views.sample_maps import by_name, class_, fact, place, thing

CLASSES = (class_("Chair"), class_("Table"))


def inconsistent(*support):
    return errors.Inconsistent(
        "no", explanation=Explanation(conclusion=None, support=support, steps=(), text="no")
    )


def is_a(name, class_name):
    return (v.entity_iri(name), v.RDF_TYPE, v.dm(class_name))


def test_a_free_name_is_suggested_for_a_taken_one():
    (fix,) = suggest_fixes(
        Add(class_="Chair", name="seat1"), errors.NameTaken("taken"), by_name(thing("seat1"))
    )
    assert fix.commands == (Add(class_="Chair", name="seat2"),)
    assert fix.text == "Use the name seat2"


def test_the_nearest_class_is_suggested_for_an_unknown_one():
    found = suggest_fixes(Add(class_="Chiar"), errors.UnknownClass("unknown"), {}, CLASSES)
    assert [fix.commands for fix in found] == [(Add(class_="Chair"),)]


def test_unsetting_asserted_premises_is_suggested():
    entities = by_name(thing("cup1", properties={"isOn": ("table1",), "mass": 2.0, "isOpen": True}))
    refused = inconsistent(
        fact("cup1", "isOn", "table1"),
        (v.entity_iri("cup1"), v.dm("mass"), v.literal("2.0", v.dm("float"))),
        (v.entity_iri("cup1"), v.dm("isOpen"), v.literal("true", v.dm("boolean"))),
        is_a("cup1", "Cup"),
    )
    command = Set(name="cup1", property="isInside", values=("table1",))
    found = suggest_fixes(command, refused, entities)
    assert [fix.commands for fix in found] == [
        (Unset(name="cup1", property="isOn", value="table1"), command),
        (Unset(name="cup1", property="mass", value=2.0), command),
        (Unset(name="cup1", property="isOpen", value=True), command),
    ]
    assert all(fix.is_destructive for fix in found)
    assert found[0].text == "Unset cup1 isOn table1 and retry"


def test_facts_of_the_command_itself_are_not_suggested():
    command = Set(name="cup1", property="isInside", values=("cup1",))
    refused = inconsistent(fact("cup1", "isInside", "cup1"))
    assert suggest_fixes(command, refused, by_name(thing("cup1"))) == ()


def test_removing_another_entity_is_suggested_but_not_a_place():
    entities = by_name(thing("cup1"), thing("table1", "Table"), place("kitchen1"))
    command = Set(name="cup1", property="isOn", values=("x",))
    refused = inconsistent(is_a("cup1", "Cup"), is_a("table1", "Table"), is_a("kitchen1", "Kitchen"))
    for refusing in (command, Batch(changes=(command,))):
        (fix,) = suggest_fixes(refusing, refused, entities)
        assert fix.commands == (Remove(names=("table1",)), refusing)


def test_force_is_suggested_where_it_helps():
    command = Update(name="milk1", class_="Kitchen")
    error = errors.Refused("milk1 is an object; if that is intended, add --force")
    (fix,) = suggest_fixes(command, error, {})
    assert fix.commands == (Update(name="milk1", class_="Kitchen", force=True),)


def test_a_retry_is_suggested_if_the_system_is_busy():
    (fix,) = suggest_fixes(Remove(names=("a",)), errors.Busy("busy"), {})
    assert fix.commands == (Remove(names=("a",)),)


def test_some_rejections_have_no_fixes():
    assert suggest_fixes(Remove(names=("a",)), errors.UnknownName("no a"), {}) == ()
