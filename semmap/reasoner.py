"""The incremental OWL 2 RL reasoner as a library: computes inferred triples and explanations.

It needs no running system. Terms are N-Triples text (`<iri>`, `"1.0"^^<datatype>`, `_:label`), and a
triple is a tuple of three.

    from semmap.reasoner import Inconsistent, Reasoner

    a = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
    sub_class_of = "<http://www.w3.org/2000/01/rdf-schema#subClassOf>"
    reasoner = Reasoner([("<urn:Cup>", sub_class_of, "<urn:Dish>")])
    reasoner.apply(insert=[("<urn:cup1>", a, "<urn:Cup>")])     # on Inconsistent, nothing changes
    print(reasoner.explain(("<urn:cup1>", a, "<urn:Dish>")).text)
"""

from semmap.nodes.kb_node.reasoner import Change, Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Step, Term, Triple

__all__ = ["Change", "Explanation", "Inconsistent", "Reasoner", "Step", "Term", "Triple"]
