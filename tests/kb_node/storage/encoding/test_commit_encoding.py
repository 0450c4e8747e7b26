import threading
import zlib

import pytest

from semmap.nodes.kb_node.storage.encoding import body_encoding, commit_encoding
from semmap.ontology import vocabulary as v
from semmap.schemas import codec
from semmap.schemas.commits import Commit, Departed
from tests.kb_node.home import chair, transaction

LONG = "x" * (64 << 20)


def commit(*triples, **fields):
    return Commit(seq=7, stamp_ns=1, id="x", source="file", inserted=triples, **fields)


def test_an_early_body_is_complete(semantic_map):
    changed = semantic_map.commit(transaction("a", chair())).changed
    triples = [(v.entity_iri(f"c{i}"), v.RDF_TYPE, v.dm("Chair")) for i in range(2000)]
    begun = commit_encoding.begin_body(commit(*triples), "")
    whole = commit(*triples, changed=changed * 300, removed=(Departed(name="b", types=("Chair",)),))
    body = begun.finish(whole).result()
    assert zlib.decompress(body) == codec.encode(whole)
    assert body_encoding.decode(body, Commit) == whole
    assert len(body) < len(codec.encode(whole)) / 10


def test_a_commit_ends_with_its_effects():
    names = (*commit_encoding._CHANGED, *commit_encoding._OTHERS)
    assert Commit.__struct_fields__[-len(names) :] == names == Commit.__struct_encode_fields__[-len(names) :]


@pytest.mark.parametrize("comes", [0, 1, 2])
def test_effects_may_differ_from_the_expected_ones(semantic_map, comes):
    changed = semantic_map.commit(transaction("a", chair())).changed * 300
    triples = [(v.entity_iri(f"c{i}"), v.RDF_TYPE, v.dm("Chair")) for i in range(2000)]
    begun = commit_encoding.begin_body(commit(*triples), "")
    begun.expect(commit(*triples, changed=changed))
    departed = (Departed(name="b", types=("Chair",)),)
    whole = commit(*triples, changed=(changed, changed[1:], ())[comes], removed=departed, notes=("x",))
    assert zlib.decompress(begun.finish(whole).result()) == codec.encode(whole)


def test_a_commit_without_effects(semantic_map):
    whole = commit(*[(v.entity_iri(f"c{i}"), v.RDFS_LABEL, v.literal("x")) for i in range(2000)])
    assert zlib.decompress(commit_encoding.begin_body(whole, "").finish(whole).result()) == codec.encode(
        whole
    )


@pytest.mark.parametrize("count", [9_999, 10_000, 10_001, 20_000, 70_001])
def test_long_lists_are_encoded_in_pieces(monkeypatch, count):
    whole = commit(
        *[(v.entity_iri(f"c{i}"), v.RDFS_LABEL, v.literal("x")) for i in range(count)],
        removed=tuple(Departed(name=f"b{i}", types=()) for i in range(count)),
        notes=("", "x"),
    )
    expected, encode, longest = codec.encode(whole), codec.encode, []

    def noted(message):
        longest.append(len(encoded := encode(message)))
        return encoded

    monkeypatch.setattr(codec, "encode", noted)
    assert zlib.decompress(commit_encoding.begin_body(whole, "").finish(whole).result()) == expected
    assert max(longest) < 2 << 20


def test_a_discarded_body_is_not_encoded_to_its_end(monkeypatch):
    begins, encode = threading.Event(), codec.encode
    monkeypatch.setattr(codec, "encode", lambda message: begins.wait(10.0) and encode(message))
    whole = commit(*[(v.entity_iri(f"c{i}"), v.RDFS_LABEL, v.literal("x")) for i in range(2000)])
    begun = commit_encoding.begin_body(whole, "")
    begun.discard()
    begins.set()
    assert len(zlib.decompressobj().decompress(begun.finish(whole).result())) < 10


@pytest.mark.parametrize(("label", "name"), [(LONG, "b"), ("x", LONG)], ids=["triples", "effects"])
def test_a_commit_with_very_long_texts(label, name):
    triples = [(v.entity_iri(f"c{i}"), v.RDFS_LABEL, v.literal("x")) for i in range(1000)]
    whole = commit(
        *triples,
        (v.entity_iri("d"), v.RDFS_LABEL, v.literal(label)),
        removed=(Departed(name=name, types=()),),
    )
    body = commit_encoding.begin_body(whole, "").finish(whole).result()
    is_the_whole = body_encoding.decode(body, Commit) == whole  # too long to be shown
    assert is_the_whole


def test_a_small_commit_has_no_early_body():
    assert commit_encoding.begin_body(commit(*chair()), "") is None
