"""Cases of entailment in abbreviated Turtle: a name, a premise and a conclusion."""

import re

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.entailment import entails
from tests.kb_node.reasoner.graphs import triples

SHORT = {
    r"SOME\((\[.*?\]|\S+) ([^\s)]+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:someValuesFrom \2 ]",
    r"ONLY\((\S+) (\S+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:allValuesFrom \2 ]",
    r"HAS\((\S+) (\S+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:hasValue \2 ]",
    r"SELF\((\S+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:hasSelf true ]",
    r"LEAST\((\S+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:minCardinality TWO ]",
    r"MOST\((\S+)\)": r"[ a owl:Restriction ; owl:onProperty \1 ; owl:maxCardinality ONE ]",
    r"NEVER\((\S+) (\S+) (\S+)\)": (
        r"a owl:NegativePropertyAssertion ; owl:sourceIndividual \1 ; owl:assertionProperty \2 ; "
        r"owl:targetIndividual \3"
    ),
    r"\b(NONE|ONE|TWO)\b": lambda found: (
        f'"{("NONE", "ONE", "TWO").index(found[0])}"^^xsd:nonNegativeInteger'
    ),
}
"""Abbreviations in the cases."""


def spelled_out(text):
    for short, long in SHORT.items():
        text = re.sub(short, long, text)
    return text


def cases(text):
    text = spelled_out(text)
    lines = [line for line in text.splitlines() if line.strip()]
    cases = []
    for line in lines:
        if not line.startswith(" "):
            cases.append((line, []))
        elif line.startswith("      "):
            cases[-1][1][-1] += line
        else:
            cases[-1][1].append(line)
    return [pytest.param(lines[0], "".join(f"{c} . " for c in lines[1:]), id=name) for name, lines in cases]


def follows(premise, conclusion):
    reasoner = Reasoner(triples(premise + " ."))
    before = picture(reasoner)
    found = entails(reasoner, triples(conclusion))
    assert picture(reasoner) == before
    return found


def picture(reasoner):
    return set(reasoner.asserted()), set(reasoner.inferred()), len(reasoner), reasoner.is_compiled
