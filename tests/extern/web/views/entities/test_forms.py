import math

import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.entities import forms
from semmap.nodes.extern.web.views.entities.forms import EntityForm
from semmap.nodes.extern.web.views.entities.states import State
from semmap.schemas import codec, errors
from semmap.schemas.commands import Add, Batch, Set, Unset, Update
from tests.extern.web.views.sample_maps import class_, thing

CUP = thing(
    "cup1",
    at=(1.0, 2.0, 0.75),
    size_m=(0.1, 0.1, 0.12),
    preferred_reference="cup",
    alternative_references=("mug",),
)


def state(kind="number", now=None, multiple=False):
    return State(name="p", label="label", kind=kind, now=now, multiple=multiple, choices={}, unit="", hint="")


def test_a_class_is_enough_to_add_an_entity():
    assert forms.build_add(EntityForm(class_=" Chair ")) == Add(class_="Chair", default=True)


def test_the_command_has_all_fields_of_the_form():
    filled = EntityForm(
        class_="Cup",
        name="cup9",
        at=(1, 2.5, 0.0),
        yaw_deg=90.0,
        size=(0.1, 0.1, 0.2),
        ref=" red cup ",
        alt="a\n\n b\na",
    )
    made = forms.build_add(filled)
    assert made.at == (1.0, 2.5, 0.0)
    assert made.yaw == pytest.approx(math.pi / 2)
    assert (made.ref, made.alt, made.default) == ("red cup", ("a", "b"), False)
    codec.convert({"verb": "add", "class": made.class_, "name": made.name, "at": list(made.at)}, Add)


@pytest.mark.parametrize(
    ("filled", "said"),
    [
        (EntityForm(), "class is required"),
        (EntityForm(class_="Cup", name="1cup"), "invalid name '1cup'"),
        (EntityForm(class_="Cup", name="<script>"), "invalid name '<script>'"),
        (EntityForm(class_="Cup", at=(1.0, None, 0.0)), "the position is incomplete"),
        (EntityForm(class_="Cup", size=(1.0, 0.0, 1.0)), "greater than 0 m"),
    ],
)
def test_invalid_forms_are_rejected_with_a_message(filled, said):
    with pytest.raises(errors.BadRequest, match=said):
        forms.build_add(filled)


def test_an_unchanged_form_sends_nothing():
    assert forms.build_update(CUP, forms.form_of(CUP)) is None


@pytest.mark.parametrize(
    ("changed", "command"),
    [
        ({"ref": "my cup"}, Update(name="cup1", ref="my cup")),
        ({"alt": ""}, Update(name="cup1", alt=())),
        ({"alt": "mug\nbeaker"}, Update(name="cup1", alt=("mug", "beaker"))),
        ({"class_": "Mug"}, Update(name="cup1", class_="Mug")),
        ({"at": (1.0, 3.0, 0.75)}, Update(name="cup1", at=(1.0, 3.0, 0.75))),
        ({"size": (0.2, 0.1, 0.12)}, Update(name="cup1", size=(0.2, 0.1, 0.12))),
        ({"yaw_deg": 0.0, "ref": "x"}, Update(name="cup1", ref="x")),
    ],
)
def test_only_changed_fields_are_sent(changed, command):
    assert forms.build_update(CUP, structs.replace(forms.form_of(CUP), **changed)) == command


def test_fields_changed_by_others_are_not_sent():
    before = forms.form_of(CUP)
    fallen = structs.replace(CUP, pose=thing("x", at=(1.0, 2.0, 0.0)).pose)
    filled = structs.replace(before, ref="my cup")
    assert forms.build_update(fallen, filled, before) == Update(name="cup1", ref="my cup")


@pytest.mark.parametrize(
    "emptied", [{"class_": " "}, {"ref": ""}, {"at": (None, None, None)}, {"size": (None, None, None)}]
)
def test_required_fields_cannot_be_emptied(emptied):
    with pytest.raises(errors.BadRequest):
        forms.build_update(CUP, structs.replace(forms.form_of(CUP), **emptied))


def test_several_entities_are_moved_by_one_offset():
    bare = thing("idea1", at=None)
    room = structs.replace(thing("room1", at=(0.0, 0.0, 0.0)), place=True)
    assert forms.build_move([CUP, bare, room], (0.5, None, -0.25)).changes == (
        Update(name="cup1", at=(1.5, 2.0, 0.5), carry=True),
        Update(name="room1", at=(0.5, 0.0, -0.25)),
    )
    with pytest.raises(errors.BadRequest, match="none of the selected entities has a position"):
        forms.build_move([bare], (1.0, 0.0, 0.0))
    with pytest.raises(errors.BadRequest, match="offset is required"):
        forms.build_move([CUP], (None, 0.0, None))


@pytest.mark.parametrize(
    ("state", "entered", "command"),
    [
        (state("switch", False), True, Set(name="a", property="p", values=(True,))),
        (state("switch", True), True, None),
        (state("switch", True), None, Unset(name="a", property="p")),
        (state("number", 2.0), "2.5", Set(name="a", property="p", values=(2.5,))),
        (state("number", 2.0), "", Unset(name="a", property="p")),
        (state("text"), "x", Set(name="a", property="p", values=("x",))),
        (state("choice", ("red",), True), ["red", "blue"], Set(name="a", property="p", values=("blue",))),
        (state("choice", ("red", "blue"), True), ["red"], Unset(name="a", property="p", value="blue")),
        (
            state("choice", ("red", "blue"), True),
            ["red", "green"],
            Update(name="a", unset=("p",), set=("p=red", "p=green")),
        ),
        (state("choice", ("red",), True), [], Unset(name="a", property="p")),
        (state("choice", "red"), "blue", Set(name="a", property="p", values=("blue",))),
    ],
)
def test_a_value_sets_or_unsets_a_state(state, entered, command):
    assert forms.build_state_change("a", state, entered) == command


def test_a_common_state_is_set_where_it_differs():
    now = {"a": False, "b": True, "c": None}
    assert forms.build_state_changes(state("switch"), True, now) == Batch(
        changes=(
            Set(name="a", property="p", values=(True,)),
            Set(name="c", property="p", values=(True,)),
        )
    )
    assert forms.build_state_changes(state("switch"), True, {"b": True}) is None


def test_invalid_numbers_are_rejected():
    with pytest.raises(errors.BadRequest, match="'heavy' is not a number"):
        forms.build_state_change("a", state("number"), "heavy")


def test_class_choices_contain_all_labels():
    choices = forms.class_choices(
        [
            class_("Cup", labels={"en": "cup", "it": "tazza"}, also=("mug",)),
            class_("Chair", labels={"en": "Chair"}),
        ]
    )
    assert choices == {"Chair": "Chair", "Cup": "Cup · cup, tazza, mug"}


CHOICES = {"Cup": "Cup · cup, tazza, mug", "Cupboard": "Cupboard · cupboard, credenza", "Mug": "Mug"}


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("Cup", "Cup"),
        ("tazz", "Cup"),
        ("CREDENZA", "Cupboard"),
        ("mug", "Mug"),
        ("cup", "Cup"),
        ("sofa", "sofa"),
    ],
)
def test_classes_are_found_by_any_label(typed, meant):
    assert forms.match_class(typed, CHOICES) == meant
