import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.documents.term_syntax import require_triples
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from tests.kb_node.home import TBOX


def test_terms_in_files_and_our_terms_are_valid():
    pose = Pose(position_m=(1e-7, -0.0, 1e3))
    require_triples(TBOX)
    require_triples(
        entity_triples.describe(
            "a", v.dm("Chair"), pose=pose, size_m=(1.0, 1.0, 1.0), preferred='è "\\\n\x01'
        )
    )


@given(st.text(), st.sampled_from([None, "en", "en-gb"]))
def test_our_literals_are_valid(text, lang):
    require_triples([("_:b0", v.LEXICAL_REFERENCE, v.literal(text, lang=lang))])


@pytest.mark.parametrize(
    "triple",
    [
        ("", "", ""),
        ("a", "b", "c"),
        ("<urn:a>", "<urn:b>", "c"),
        ("<urn:a b>", "<urn:b>", "<urn:c>"),
        ("<a>", "<urn:b>", "<urn:c>"),
        ("<urn:a>\n", "<urn:b>", "<urn:c>"),
        ("<urn:a>", "_:b", "<urn:c>"),
        ("<urn:a>", '"b"', "<urn:c>"),
        ('"a"', "<urn:b>", "<urn:c>"),
        ("<urn:a>", "<urn:b>", '"open'),
        ("<urn:a>", "<urn:b>", '"a" . <urn:x> <urn:y> "b"'),
        ("<urn:a>", "<urn:b>", '"line\nend"'),
        ("<urn:a>", "<urn:b>", '"x"^^float'),
        ("<urn:a>", "<urn:b>", '"x"@'),
        ("<javascript:alert(1)>", "<urn:b>", "<urn:c>"),
        ("<urn:a>", "<urn:b>", "<JavaScript:alert(1)>"),
        ("<urn:a>", "<urn:b>", "<data:text/html,x>"),
        ("_:", "<urn:b>", "<urn:c>"),
    ],
)
def test_invalid_triples_are_rejected(triple):
    with pytest.raises(errors.BadRequest, match="not a valid N-Triples statement"):
        require_triples([("<urn:a>", "<urn:b>", "<urn:c>"), triple])
