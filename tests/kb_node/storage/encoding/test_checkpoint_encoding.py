from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.storage.encoding import body_encoding, checkpoint_encoding
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint, decode, encode
from semmap.schemas import codec
from tests.recorder.messages import entity

TERMS = st.sampled_from(["<urn:a>", "<urn:b>", '"a text"@en', '"é\\n"', "_:b1"])
TRIPLES = st.lists(st.tuples(TERMS, TERMS, TERMS), max_size=20).map(tuple)


@given(TRIPLES)
def test_encoding_is_reversible(triples):
    checkpoint = Checkpoint(seq=7, triples=triples, entities=(entity("cup1", "Cup"),), read_by=b"1")
    assert decode(encode(checkpoint)) == checkpoint


def test_frames_follow_one_another(monkeypatch):
    monkeypatch.setattr(checkpoint_encoding, "_TRIPLES", 2)
    monkeypatch.setattr(checkpoint_encoding, "_ENTITIES", 2)
    told = []
    checkpoint = Checkpoint(
        seq=7,
        triples=tuple(("<urn:s>", f"<urn:p{i % 3}>", f"<urn:o{i}>") for i in range(7)),
        entities=tuple(entity(f"cup{i}", "Cup") for i in range(5)),
    )
    body = encode(checkpoint, lambda: told.append("write"))
    assert decode(body, lambda: told.append("read")) == checkpoint
    assert told.count("write") == told.count("read") == 4 + 3


def test_equal_terms_are_one_object():
    triples = tuple((f"<urn:{s}>", "<urn:p>", "<urn:o>") for s in "ab")
    a, b = decode(encode(Checkpoint(seq=1, triples=triples))).triples
    assert a[1] is b[1]
    assert a[2] is b[2]


def test_entities_share_what_they_have_in_common():
    cups = (entity("a", "Cup"), entity("b", "Cup"))
    a, b = decode(encode(Checkpoint(seq=1, entities=cups))).entities
    assert (a, b) == cups
    assert a.types is b.types
    assert a.provenance is b.provenance


def test_checkpoints_of_older_versions_are_read():
    checkpoint = Checkpoint(seq=7, triples=(("<urn:a>", "<urn:b>", '"c"'),), entities=(entity("a", "Cup"),))
    assert decode(codec.encode(checkpoint)) == checkpoint
    assert decode(body_encoding.encode(checkpoint, compressed_from=1)) == checkpoint
