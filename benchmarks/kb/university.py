"""Generated university data like LUBM's: departments, people, courses, publications; the engine alone.

The ontology has the constructs of LUBM: class and property hierarchies, an inverse and a transitive property,
domains and ranges, and classes defined by what their members do.
"""

from __future__ import annotations

import gc
import random
from collections.abc import Iterator
from importlib.util import find_spec
from typing import NamedTuple

import psutil
import pyoxigraph

from benchmarks.kb.made import cost
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_UNIVERSITY = "http://example.org/university#"
_TBOX = """
@prefix : <http://example.org/university#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
:Organization a owl:Class . :University a owl:Class ; rdfs:subClassOf :Organization .
:Department a owl:Class ; rdfs:subClassOf :Organization . :Group a owl:Class ; rdfs:subClassOf :Organization .
:Person a owl:Class . :Employee a owl:Class ; rdfs:subClassOf :Person . :Student a owl:Class ; rdfs:subClassOf :Person .
:Faculty a owl:Class ; rdfs:subClassOf :Employee . :Professor a owl:Class ; rdfs:subClassOf :Faculty .
:FullProfessor a owl:Class ; rdfs:subClassOf :Professor . :Lecturer a owl:Class ; rdfs:subClassOf :Faculty .
:Undergraduate a owl:Class ; rdfs:subClassOf :Student . :Graduate a owl:Class ; rdfs:subClassOf :Student .
:Course a owl:Class . :GraduateCourse a owl:Class ; rdfs:subClassOf :Course . :Publication a owl:Class .
:Chair a owl:Class ; owl:equivalentClass [ owl:intersectionOf ( :Person
    [ a owl:Restriction ; owl:onProperty :headOf ; owl:someValuesFrom :Department ] ) ] .
:Learner a owl:Class ; owl:equivalentClass [ owl:intersectionOf ( :Person
    [ a owl:Restriction ; owl:onProperty :takes ; owl:someValuesFrom :Course ] ) ] .
:memberOf a owl:ObjectProperty ; rdfs:domain :Person ; rdfs:range :Organization ; owl:inverseOf :member .
:worksFor a owl:ObjectProperty ; rdfs:subPropertyOf :memberOf . :headOf rdfs:subPropertyOf :worksFor .
:partOf a owl:ObjectProperty , owl:TransitiveProperty ; rdfs:domain :Organization ; rdfs:range :Organization .
:takes a owl:ObjectProperty ; rdfs:range :Course . :teaches a owl:ObjectProperty ; rdfs:domain :Faculty ; rdfs:range :Course .
:advisor a owl:ObjectProperty ; rdfs:domain :Person ; rdfs:range :Professor .
:author a owl:ObjectProperty ; rdfs:domain :Publication ; rdfs:range :Person .
:degreeFrom a owl:ObjectProperty ; rdfs:domain :Person ; rdfs:range :University ; owl:inverseOf :hasAlumnus .
:doctorateFrom rdfs:subPropertyOf :degreeFrom .
:name a owl:DatatypeProperty . :email a owl:DatatypeProperty ; rdfs:domain :Person .
"""  # noqa: E501
_DEPARTMENTS = 18


class University(NamedTuple):
    """Figures of one size: duration of all inferences [s] and additional memory [MB]."""

    triples: int
    inferred: int
    load_s: float
    load_cpu_s: float
    enumerate_s: float
    enumerate_cpu_s: float
    memory_mb: float


def measure(triples: int) -> University:
    """Load about `triples` triples with the ontology, and iterate over all inferences."""
    tbox = [(str(q.subject), str(q.predicate), str(q.object)) for q in _parsed()]
    data = list(dict.fromkeys(_data(triples)))
    gc.collect()
    before = psutil.Process().memory_info().rss
    reasoners: list[Reasoner] = []
    gc.disable()
    load = cost(lambda: reasoners.append(Reasoner([*tbox, *data])))
    gc.enable()
    gc.freeze()
    added = psutil.Process().memory_info().rss - before
    counted: list[int] = []
    walk = cost(lambda: counted.append(sum(1 for _ in reasoners[0].inferred())))
    return University(len(data), counted[0], load.wall_s, load.cpu_s, walk.wall_s, walk.cpu_s, added / 1e6)


def against_reasonable(triples: int) -> float | None:
    """Return `reasonable`'s CPU time for the closure of the same triples [s]; None if it is not installed."""
    if find_spec("reasonable") is None:
        return None
    import rdflib
    import reasonable

    tbox = [(str(q.subject), str(q.predicate), str(q.object)) for q in _parsed()]
    lines = "".join(f"{s} {p} {o} .\n" for s, p, o in (*tbox, *dict.fromkeys(_data(triples))))
    reasoner = reasonable.PyReasoner()
    reasoner.from_graph(rdflib.Graph().parse(data=lines, format="nt"))
    return cost(reasoner.reason).cpu_s


def _parsed() -> Iterator[pyoxigraph.Quad]:
    return pyoxigraph.parse(_TBOX, format=pyoxigraph.RdfFormat.TURTLE)


def _data(size: int) -> Iterator[Triple]:
    random_, said, number = random.Random(size), 0, 0
    while said < size:
        for triple in _university(number, random_):
            said += 1
            yield triple
            if said >= size:
                return
        number += 1


def _university(number: int, random_: random.Random) -> Iterator[Triple]:
    university = _named(f"u{number}")
    yield (university, v.RDF_TYPE, _term("University"))
    for i in range(_DEPARTMENTS):
        yield from _department(f"u{number}d{i}", university, random_)


def _department(name: str, university: Term, random_: random.Random) -> Iterator[Triple]:
    department = _named(name)
    yield (department, v.RDF_TYPE, _term("Department"))
    yield (department, _term("partOf"), university)
    for i in range(random_.randint(10, 20)):
        group = _named(f"{name}g{i}")
        yield from ((group, v.RDF_TYPE, _term("Group")), (group, _term("partOf"), department))
    courses, professors = [], []
    for i in range(random_.randint(30, 40)):
        person = _named(f"{name}f{i}")
        rank = "FullProfessor" if i < 10 else "Professor" if i < 25 else "Lecturer"
        yield from _person(person, f"{name}f{i}", rank)
        yield (person, _term("headOf" if i == 0 else "worksFor"), department)
        yield (person, _term("doctorateFrom"), university)
        for kind in ("Course", "GraduateCourse"):
            course = _named(f"{name}f{i}{kind}")
            courses.append(course)
            yield from ((course, v.RDF_TYPE, _term(kind)), (person, _term("teaches"), course))
        if rank != "Lecturer":
            professors.append(person)
            for k in range(random_.randint(5, 15)):
                publication = _named(f"{name}f{i}p{k}")
                yield (publication, v.RDF_TYPE, _term("Publication"))
                yield (publication, _term("author"), person)
    for i in range(random_.randint(400, 600)):
        person, kind = _named(f"{name}s{i}"), "Graduate" if i % 5 == 0 else "Undergraduate"
        yield from _person(person, f"{name}s{i}", kind)
        yield (person, _term("memberOf"), department)
        for course in random_.sample(courses, random_.randint(2, 4)):
            yield (person, _term("takes"), course)
        if i % 5 == 0:
            yield (person, _term("advisor"), random_.choice(professors))


def _person(person: Term, name: str, kind: str) -> Iterator[Triple]:
    yield (person, v.RDF_TYPE, _term(kind))
    yield (person, _term("name"), f'"{name}"')
    yield (person, _term("email"), f'"{name}@example.org"')


def _term(name: str) -> Term:
    return f"<{_UNIVERSITY}{name}>"


def _named(name: str) -> Term:
    return f"<http://example.org/{name}>"
