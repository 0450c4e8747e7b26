"""The journal: an append-only SQLite file of commits, whose digests form a chain."""

from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.nodes.kb_node.storage.journal.journal import Journal
from semmap.nodes.kb_node.storage.journal.layout import FILENAME

__all__ = ["FILENAME", "Checkpoint", "Journal"]
