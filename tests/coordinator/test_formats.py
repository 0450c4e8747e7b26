"""The entity list in the formats of other systems."""

from __future__ import annotations

from msgspec import structs

from semmap.nodes.coordinator import formats
from tests.coordinator.reconciler.test_reconcile import at, entity

CHAIR = structs.replace(
    entity("chair1", at(1.0, -2.0, 0.5)),
    preferred_reference="seat",
    alternative_references=("stool", "bench"),
)
NOWHERE = entity("chair2", None)


def test_lu4r_has_words_and_a_coordinate_of_text():
    assert formats.lu4r((CHAIR, NOWHERE)) == {
        "entities": [
            {
                "atom": "chair1",
                "type": "Chair",
                "preferredLexicalReference": "seat",
                "alternativeLexicalReferences": ["stool", "bench"],
                "coordinate": {"x": "1.0", "y": "-2.0", "z": "0.5", "angle": "0.0"},
            },
            {
                "atom": "chair2",
                "type": "Chair",
                "preferredLexicalReference": "",
                "alternativeLexicalReferences": [],
            },
        ]
    }


def test_the_legacy_format_is_keyed_by_iri():
    assert formats.legacy((CHAIR, NOWHERE), {"Chair": "urn:Chair"}) == {
        "http://example.org/chair1": {
            "type_full": "urn:Chair",
            "preferredLexicalReference": "seat",
            "atom": "chair1",
            "type": "Chair",
            "coordinate": {"x": "1.0", "y": "-2.0", "z": "0.5"},
            "coordinates": "1.0,-2.0,0.5",
        },
        "http://example.org/chair2": {
            "type_full": "urn:Chair",
            "preferredLexicalReference": "",
            "atom": "chair2",
            "type": "Chair",
        },
    }
