"""Triples in frames, and a document after them, are loaded into a store on disk."""

import gzip
import io
from types import SimpleNamespace

import pyoxigraph as ox
import pytest

from semmap.nodes.kb_node.sparql.triples import bulk_load

TRIPLES = [(f"<urn:s{i}>", "<urn:p>", '"é"@fr') for i in range(3)]
TURTLE = b"<c> <urn:p> 1.0 , 1.00 ."


@pytest.mark.parametrize(
    ("arguments", "document", "count", "subject"),
    [
        ((), b"", 3, "urn:s2"),
        (("urn:base/",), TURTLE, 4, "urn:base/c"),  # one value in two spellings
        (("urn:base/", bulk_load.PACKED), gzip.compress(TURTLE), 4, "urn:base/c"),
    ],
    ids=["frames", "a document", "a compressed document"],
)
def test_frames_and_a_document_are_loaded(tmp_path, monkeypatch, capsys, arguments, document, count, subject):
    frames = bulk_load.frame(TRIPLES[:2]) + bulk_load.frame(TRIPLES[2:]) + bulk_load.END
    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=io.BytesIO(frames + document)))
    monkeypatch.setattr("os.nice", lambda by: None)
    bulk_load.main(str(tmp_path), *arguments)
    assert capsys.readouterr().out == f"{count}\n"
    found = {str(quad.subject.value) for quad in ox.Store.read_only(str(tmp_path))}
    assert found >= {"urn:s0", "urn:s1", subject}
