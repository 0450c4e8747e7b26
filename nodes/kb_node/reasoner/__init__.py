"""An incremental, explaining OWL 2 RL reasoner in plain Python."""

from nodes.kb_node.reasoner.reasoner import Change, Inconsistent, Reasoner

__all__ = ["Change", "Inconsistent", "Reasoner"]
