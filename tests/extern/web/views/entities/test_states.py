from msgspec import structs

from semmap.nodes.extern.web.views.entities.states import common_states, list_states
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import PropertyInfo
from tests.extern.web.views.sample_maps import by_name, thing


def prop(name, kind="data", *, range_=(), domain=("Object",), functional=True, **fields):
    return PropertyInfo(
        name=name, iri=f"http://x/{name}", kind=kind, functional=functional, domain=domain, range=range_,
        datatypes=fields.pop("datatypes", range_ if kind == "data" else ()),
        labels=fields.pop("labels", {}), values=fields.pop("values", {}), **fields
    )  # fmt: skip


OPEN = prop("isOpen", range_=("boolean",), labels={"en": "is open"})
MASS = prop("mass", range_=("float from 0 to 1e9",), datatypes=("float",), comment="In kilograms.")
COLOR = prop("hasColor", "object", range_=("Color",), values={"color_red": "red"}, functional=False)
OWNER = prop("isOwnedBy", "object", range_=("Person",), functional=False)
SERIAL = prop("serialNumber", range_=("string",), domain=("Device",))
ALL = (SERIAL, OWNER, COLOR, MASS, OPEN)
DOOR = thing("door1", "Door", types=("Object",), properties={"hasColor": ("color_red",)})
ANNA = thing("anna", "Person", types=("Object",), preferred_reference="Anna")
THINGS = by_name(DOOR, ANNA)


def test_properties_that_fit_the_class_are_listed_asserted_ones_first():
    found = list_states(DOOR, ALL, THINGS)
    assert [(s.name, s.kind) for s in found] == [
        ("hasColor", "choice"),
        ("isOpen", "switch"),
        ("mass", "number"),
        ("isOwnedBy", "thing"),
    ]


def test_a_state_has_value_label_and_unit():
    color, open_, mass, owner = list_states(DOOR, ALL, THINGS)
    assert (color.now, color.text, color.choices) == (("color_red",), "red", {"color_red": "red"})
    assert (open_.label, open_.now, open_.text) == ("is open", None, "")
    assert mass.unit == "kilograms"
    assert owner.choices == {"anna": "anna (Anna)"}


def test_computed_relations_are_states_only_if_asserted():
    on = prop("isOn", "object", range_=("Object",), functional=False)
    assert [s.name for s in list_states(thing("a", types=("Object",)), (on,), {})] == []
    stated = thing("a", types=("Object",), properties={"isOn": ("b",)})
    assert [s.name for s in list_states(stated, (on,), {})] == ["isOn"]


def test_common_states_are_those_of_all_entities():
    device = thing("lamp1", "Lamp", types=("Object", "Device"), properties={"isOpen": True, "mass": 2.0})
    other = thing("lamp2", "Lamp", types=("Object",), properties={"isOpen": True, "mass": 3.0})
    found = {s.name: s.now for s in common_states([device, other], ALL, THINGS)}
    assert found == {"isOpen": True, "mass": None, "hasColor": None, "isOwnedBy": None}
    assert common_states([], ALL, THINGS) == ()


def test_is_open_is_offered_for_openable_things_only():
    is_open = structs.replace(OPEN, iri=f"{v.TBOX}isOpen", domain=("Physical_Thing",))
    fridge = thing("fridge1", "Fridge", types=("Physical_Thing", "Openable_Thing"))
    table = thing("table1", "Table", types=("Physical_Thing",))
    said = thing("table2", "Table", types=("Physical_Thing",), properties={"isOpen": True})
    assert [state.name for state in list_states(fridge, [is_open], {})] == ["isOpen"]
    assert list_states(table, [is_open], {}) == ()
    assert [state.now for state in list_states(said, [is_open], {})] == [True]
