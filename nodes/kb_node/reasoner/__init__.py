"""An incremental OWL 2 RL reasoner in plain Python that explains its conclusions.

Names are imported on first use, so that importing only `explain.words` does not load the rules.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from semmap.nodes.kb_node.reasoner.change import Change
    from semmap.nodes.kb_node.reasoner.entailment import entails
    from semmap.nodes.kb_node.reasoner.fastpaths.runs import Form
    from semmap.nodes.kb_node.reasoner.fastpaths.shapes import UniformRuns
    from semmap.nodes.kb_node.reasoner.reasoner import GivenFacts, Inconsistent, Reasoner
    from semmap.nodes.kb_node.reasoner.refutation import refute

__all__ = ["Change", "Form", "GivenFacts", "Inconsistent", "Reasoner", "UniformRuns", "entails", "refute"]

_MODULES = {
    "UniformRuns": "fastpaths.shapes",
    "Change": "change",
    "Form": "fastpaths.runs",
    "GivenFacts": "reasoner",
    "Inconsistent": "reasoner",
    "Reasoner": "reasoner",
    "entails": "entailment",
    "refute": "refutation",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
