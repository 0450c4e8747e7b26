"""The classes of the household TBox, as the knowledge base sends them to other nodes."""

from functools import cache

from semmap.nodes.kb_node.documents.ontology_files import gather
from semmap.nodes.kb_node.documents.tbox.tbox_validation import compile_tbox
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas.entities import ClassInfo


@cache
def household_classes() -> tuple[ClassInfo, ...]:
    """Return the classes of the household TBox."""
    return tuple(ClassTable(compile_tbox(gather([HOUSEHOLD_TTL], {}).triples)).rows)
