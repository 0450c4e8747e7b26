"""Entailment beyond the rules: by refutation, generic individuals, and names for existing values."""

from semmap.nodes.kb_node.reasoner.entailment.conclusions import contradictory, entails

__all__ = ["contradictory", "entails"]
