"""An incremental, explaining OWL 2 RL reasoner in plain Python."""

from nodes.kb_node.reasoner.change import Change
from nodes.kb_node.reasoner.entailment import entails
from nodes.kb_node.reasoner.fastpaths.runs import Run
from nodes.kb_node.reasoner.fastpaths.shapes import Alike
from nodes.kb_node.reasoner.reasoner import Held, Inconsistent, Reasoner
from nodes.kb_node.reasoner.refutation import refute

__all__ = ["Alike", "Change", "Held", "Inconsistent", "Reasoner", "Run", "entails", "refute"]
