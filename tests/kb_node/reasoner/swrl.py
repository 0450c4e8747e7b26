"""SWRL rules for the tests, written as `Cup(x), on(x, y) -> Clutter(y)`."""

import re

from tests.kb_node.reasoner.graphs import triples

PREFIXES = """
@prefix swrl: <http://www.w3.org/2003/11/swrl#> . @prefix swrlb: <http://www.w3.org/2003/11/swrlb#> .
:x a swrl:Variable . :y a swrl:Variable . :z a swrl:Variable . :v a swrl:Variable . :w a swrl:Variable .
"""
_EQUALITIES = {"sameAs": "SameIndividualAtom", "differentFrom": "DifferentIndividualsAtom"}


def rule(text):
    """Return a rule in Turtle. Names of classes begin with a capital letter, those of built-ins with `b.`."""
    body, head = ([_atom(atom) for atom in re.findall(r"[\w.]+\([^)]*\)", part)] for part in text.split("->"))
    return f"[] a swrl:Imp ; swrl:body ({' '.join(body)}) ; swrl:head ({' '.join(head)}) ."


def _atom(text):
    name, arguments = re.fullmatch(r"([\w.]+)\((.*)\)", text).groups()
    arguments = [a if re.match(r'[0-9"-]', a) else f":{a}" for a in arguments.split(", ")]
    if name.startswith("b."):
        return (
            f"[ a swrl:BuiltinAtom ; swrl:builtin swrlb:{name[2:]} ; swrl:arguments ({' '.join(arguments)}) ]"
        )
    places = " ; ".join(f"swrl:argument{i} {argument}" for i, argument in enumerate(arguments, 1))
    if name in _EQUALITIES:
        return f"[ a swrl:{_EQUALITIES[name]} ; {places} ]"
    if name[0].isupper():
        return f"[ a swrl:ClassAtom ; swrl:classPredicate :{name} ; {places} ]"
    kind = "DatavaluedPropertyAtom" if name.startswith("d") else "IndividualPropertyAtom"
    return f"[ a swrl:{kind} ; swrl:propertyPredicate :{name} ; {places} ]"


def graph(*rules, axioms=""):
    """Return the triples of rules and of other axioms in Turtle."""
    return triples(PREFIXES + axioms + "\n".join(map(rule, rules)))
