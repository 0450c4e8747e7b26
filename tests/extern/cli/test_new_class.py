from types import SimpleNamespace

import pytest

from semmap.nodes.extern.cli.new_class import class_name, declare_class, find_class
from semmap.schemas.errors import BadRequest

CLASSES = [
    SimpleNamespace(name="Object", iri="http://x.org/#Object", labels={"en": "object"}, also=()),
    SimpleNamespace(
        name="Drill", iri="http://x.org/#Drill", labels={"en": "cordless drill"}, also=("driver",)
    ),
]


def test_words_become_a_name():
    assert class_name("power drill") == "Power_Drill"
    assert class_name("USB-C  hub") == "USB_C_Hub"
    assert class_name("tè caldo") == "Tè_Caldo"
    for words in ("3 in 1", "--", ""):
        with pytest.raises(BadRequest, match="begins with a letter"):
            class_name(words)


def test_a_class_is_found_by_name_or_label():
    assert [find_class(words, CLASSES) for words in ("drill", "Cordless Drill", "DRIVER", "saw")] == [
        "Drill",
        "Drill",
        "Drill",
        None,
    ]


def test_a_new_class_is_declared_below_object_with_its_words_as_label():
    made = declare_class('power "drill"', CLASSES)
    assert made.name == "Power_Drill"
    assert "<http://x.org/#Power_Drill> a <http://www.w3.org/2002/07/owl#Class>" in made.turtle
    assert "subClassOf> <http://x.org/#Object>" in made.turtle
    assert '"power \\"drill\\""@en .' in made.turtle
    assert '"drill \U0001f527"@en .' in declare_class("drill \U0001f527", CLASSES).turtle  # no surrogates
    with pytest.raises(BadRequest, match="the TBox has no class Object"):
        declare_class("drill", CLASSES[1:])
