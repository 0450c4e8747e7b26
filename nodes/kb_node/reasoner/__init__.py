"""An incremental, explaining OWL 2 RL reasoner in plain Python.

Its parts are imported when they are first asked for: who only wants its words need not wait for the rules.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from semmap.nodes.kb_node.reasoner.change import Change
    from semmap.nodes.kb_node.reasoner.entailment import entails
    from semmap.nodes.kb_node.reasoner.fastpaths.runs import Form
    from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Alike
    from semmap.nodes.kb_node.reasoner.reasoner import Held, Inconsistent, Reasoner
    from semmap.nodes.kb_node.reasoner.refutation import refute

__all__ = ["Alike", "Change", "Form", "Held", "Inconsistent", "Reasoner", "entails", "refute"]

_WHERE = {
    "Alike": "fastpaths.shapes",
    "Change": "change",
    "Form": "fastpaths.runs",
    "Held": "reasoner",
    "Inconsistent": "reasoner",
    "Reasoner": "reasoner",
    "entails": "entailment",
    "refute": "refutation",
}


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
