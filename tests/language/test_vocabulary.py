"""The vocabulary: classes by label, name and synonym, and their superclasses."""

from semmap.nodes.language.vocabulary import vocabulary
from tests.language.household import LEXICON

KNOWN = vocabulary(
    [("Couch", "divano"), ("Dining_Table", "dining table"), ("Table", "table"), ("Furniture", "furniture")],
    [("Dining_Table", "Table"), ("Table", "Furniture"), ("Couch", "Furniture"), ("Furniture", "Furniture")],
    LEXICON,
)


def test_a_class_is_found_by_its_label_its_name_and_a_synonym():
    found = {text: KNOWN.class_of(text) for text in ("divano", "couch", "sofa", "dining table", "unicorn")}
    assert found == {
        "divano": "Couch",
        "couch": "Couch",
        "sofa": "Couch",
        "dining table": "Dining_Table",
        "unicorn": None,
    }


def test_above_a_class_is_itself_and_all_that_it_is_a_kind_of():
    assert KNOWN.above["Dining_Table"] == {"Dining_Table", "Table", "Furniture"}
    assert KNOWN.above["Furniture"] == {"Furniture"}
    assert KNOWN.above["Couch"] == {"Couch", "Furniture"}


def test_the_first_that_is_called_so_is_meant():
    twice = vocabulary([("Desk", "bureau"), ("Office", "bureau")], [], LEXICON)
    assert twice.class_of("bureau") == "Desk"
