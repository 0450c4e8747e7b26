"""Loading documents, without the wire."""

from contextlib import nullcontext

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.handlers.changing import Changing
from semmap.nodes.kb_node.handlers.loading import Loading
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.entities import Pose


class NoSparql:
    def foresee(self, *document, packed):
        """Nothing."""

    def forget(self):
        """Nothing."""


def loading(semantic_map, said):
    def telling_of(work):
        return nullcontext(lambda text: said.append(f"{work}: {text}"))

    changing = Changing(
        semantic_map,
        semantic_map._journal,
        spread=lambda commit, **how: None,
        not_written=said.append,
        telling_of=telling_of,
    )
    return Loading(
        semantic_map, semantic_map._journal, changing, NoSparql(), telling_of=telling_of, notes=lambda: ()
    )


def test_a_load_counts_what_it_describes_and_not_what_follows_of_others(flat):
    said = []
    star = entity_triples.describe("apple9", v.dm("Apple"), pose=Pose(position_m=(9.81, 0.34, 0.1)))
    document = LoadDocument(
        id="1",
        source="file",
        content=rdf.serialise(star, "ntriples"),
        filename="apple.nt",
        replace=False,
        skip_unknown=False,
    )
    loaded = loading(flat, said).on_load(document)
    assert {entity.name for entity in loaded.commit.changed} == {
        "apple9",
        "bin1",
    }  # which is a Filled_Thing now
    assert loaded.names == ("apple9",)
    assert said[-1] == f"loading apple.nt: {len(star)} triples to check and write"
