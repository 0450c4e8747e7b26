"""The shipped flat with a person and two cups added, as commands are read in it."""

import pytest

from semmap.nodes.kb_node.answers.command_parser import CommandParser
from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import FLAT_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.commands import Understand
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home


@pytest.fixture(scope="session")
def read(tmp_path_factory):
    """Return what a command in words means in that flat."""
    flat = SemanticMap(home.new_household_journal(tmp_path_factory.mktemp("flat")))
    abox = rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")
    flat.commit(Transaction(id="flat", source="file", insert=tuple(abox)))
    x, y, _ = flat.entity("table1").pose.position_m
    _, _, top = flat.entity("bowl1").pose.position_m
    kitchen = flat.entity("kitchen1").pose.position_m
    triples = []
    for colour, left in (("red", -0.3), ("blue", 0.3)):
        pose = Pose(position_m=(x + left, y + 0.1, top))
        triples += entity_triples.describe(f"{colour}cup", v.dm("Cup"), pose=pose, size_m=[0.08, 0.08, 0.1])
        triples.append((v.entity_iri(f"{colour}cup"), v.dm("hasMainColor"), v.dm(f"color_{colour}")))
    triples += entity_triples.describe(
        "nora1", v.dm("Person"), pose=Pose(position_m=(kitchen[0], kitchen[1], 0.0)), size_m=[0.4, 0.5, 1.7],
        preferred="Nora",
    )  # fmt: skip
    flat.commit(Transaction(id="more", source="operator", insert=tuple(triples)))
    parser = CommandParser(flat, EntitySearch(flat))
    yield lambda text: parser.parse(Understand(text=text))
    home.close(flat)
