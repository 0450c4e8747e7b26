"""What follows although no rule derives it: by refutation, generic individuals and names for what exists."""

from semmap.nodes.kb_node.reasoner.entailment.conclusions import contradictory, entails

__all__ = ["contradictory", "entails"]
