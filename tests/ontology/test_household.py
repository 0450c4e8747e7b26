import re
from pathlib import Path

import pytest
from rdflib import OWL, RDF, RDFS, XSD, Graph, URIRef
from rdflib.collection import Collection

from semmap.ontology import vocabulary
from tests.ontology.graphs import DM, classes, local, named, superclasses

PROPERTY_KINDS = (OWL.ObjectProperty, OWL.DatatypeProperty, OWL.AnnotationProperty)
SIMPLE_ONLY = (
    OWL.FunctionalProperty,
    OWL.InverseFunctionalProperty,
    OWL.IrreflexiveProperty,
    OWL.AsymmetricProperty,
)


def taxonomy(path: Path) -> dict[str, str | None]:
    """Each class of the taxonomy file with its superclass: two spaces a level."""
    parents: dict[str, str | None] = {}
    branch: list[str] = []
    for line in path.read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        depth = (len(line) - len(line.lstrip())) // 2
        branch[depth:] = [line.strip()]
        parents[line.strip()] = branch[depth - 1] if depth else None
    return parents


def ours(graph: Graph, *kinds: URIRef) -> set[URIRef]:
    return {s for kind in kinds for s in graph.subjects(RDF.type, kind) if str(s).startswith(str(DM))}


def nearest(graph: Graph, cls: URIRef, annotation: URIRef) -> object:
    """The value of an annotation at the class or its nearest superclass that has one."""
    level = {cls}
    while level:
        for value in (v for c in level for v in graph.objects(c, annotation)):
            return value.toPython()
        level = {p for c in level for p in graph.objects(c, RDFS.subClassOf) if isinstance(p, URIRef)}
    return None


def test_taxonomy_is_there_with_its_hierarchy(tbox: Graph, data_dir: Path) -> None:
    parents = taxonomy(data_dir / "taxonomy.txt")
    assert len(parents) > 190
    known = classes(tbox)
    for name, parent in parents.items():
        asserted = {local(p) for p in tbox.objects(named(name), RDFS.subClassOf) if isinstance(p, URIRef)}
        assert named(name) in known, name
        assert asserted == ({parent} if parent else set()), name


def test_every_class_and_property_is_labelled_and_explained(tbox: Graph) -> None:
    terms = classes(tbox) | ours(tbox, *PROPERTY_KINDS)
    assert len(terms) > 300
    for term in terms:
        languages = sorted(str(label.language) for label in tbox.objects(term, RDFS.label))
        comments = [comment.language for comment in tbox.objects(term, RDFS.comment)]
        assert (languages, comments) == (["en", "it"], ["en"]), term


def test_comments_are_not_shared(tbox: Graph) -> None:
    comments = [str(c) for c in tbox.objects(None, RDFS.comment)]
    assert len(comments) == len(set(comments))


def test_individuals_are_labelled(tbox: Graph) -> None:
    individuals = ours(tbox, OWL.NamedIndividual)
    assert {DM.containing, DM.supporting, DM.color_red} <= individuals
    for individual in individuals:
        assert sorted(str(label.language) for label in tbox.objects(individual, RDFS.label)) == ["en", "it"]


def named_superclasses(graph: Graph, cls: URIRef) -> set[URIRef]:
    """Superclasses, also through the named members of a definition's intersection."""
    found = superclasses(graph, cls)
    for definition in [d for c in found for d in graph.objects(c, OWL.equivalentClass)]:
        for members in graph.objects(definition, OWL.intersectionOf):
            found |= {
                c for m in Collection(graph, members) if isinstance(m, URIRef) for c in superclasses(graph, m)
            }
    return found


def test_no_class_is_below_two_disjoint_ones(tbox: Graph) -> None:
    groups = [set(Collection(tbox, members)) for members in tbox.objects(None, OWL.members)]
    groups += [{a, b} for a, b in tbox.subject_objects(OWL.disjointWith)]
    assert len(groups) > 20
    for cls in classes(tbox):
        above = named_superclasses(tbox, cls)
        assert all(len(above & group) < 2 for group in groups), cls


def test_no_term_is_used_undeclared(tbox: Graph) -> None:
    declared = set(tbox.subjects(RDF.type, None))
    used = {term for triple in tbox for term in triple if str(term).startswith(str(DM))}
    assert used <= declared


def test_no_two_classes_differ_only_in_case_and_underscores(tbox: Graph) -> None:
    folded = [local(c).replace("_", "").lower() for c in classes(tbox)]
    assert len(folded) == len(set(folded))


def test_header(tbox: Graph) -> None:
    (ontology,) = tbox.subjects(RDF.type, OWL.Ontology)
    assert f"<{ontology}>" == vocabulary.TBOX_ONTOLOGY
    assert tbox.value(ontology, OWL.versionInfo) is not None
    assert "LICENSE-2.0" in str(tbox.value(ontology, URIRef("http://purl.org/dc/terms/license")))


def test_vocabulary_names_terms_of_the_tbox(tbox: Graph) -> None:
    declared = {f"<{s}>" for s in tbox.subjects(RDF.type, None)}
    constants = [value for name, value in vars(vocabulary).items() if name.isupper()]
    terms = [t for value in constants for t in (value if isinstance(value, tuple) else (value,))]
    of_tbox = [t for t in terms if isinstance(t, str) and t.startswith(f"<{vocabulary.TBOX}")]
    assert len(of_tbox) > 20
    assert set(of_tbox) <= declared


def test_models(tbox: Graph) -> None:
    models = {cls: str(model) for cls, model in tbox.subject_objects(DM.model)}
    assert len(models) >= 65
    assert len(set(models.values())) >= 65
    for cls, model in models.items():
        assert re.fullmatch(r"[a-z]+(_[a-z]+)*", model), cls
        ancestors = superclasses(tbox, cls)
        assert DM.Physical_Thing in ancestors, cls
        assert DM.Location not in ancestors, cls


@pytest.mark.parametrize(
    ("name", "fixed"),
    [
        ("Door", True),
        ("Window", True),
        ("Blinds", True),
        ("Sink", True),
        ("Heating", True),
        ("Picture", True),
        ("Switch", True),
        ("Light", True),
        ("Lamp", False),
        ("Floor_Lamp", False),
        ("Chair", None),
        ("Cup", None),
    ],
)
def test_fixed(tbox: Graph, name: str, fixed: bool | None) -> None:
    assert nearest(tbox, named(name), DM.fixed) is fixed


def test_subclasses_inherit_the_nearest_model(tbox: Graph) -> None:
    assert nearest(tbox, DM.Dining_Table, DM.model) == "table"
    assert nearest(tbox, DM.Armchair, DM.model) == "armchair"
    assert nearest(tbox, DM.Furniture, DM.model) is None


@pytest.mark.parametrize("quantity", ["coordinates", "size"])
@pytest.mark.parametrize("axis", "xyz")
def test_quantities_are_single_floats(tbox: Graph, quantity: str, axis: str) -> None:
    prop = named(f"float_{quantity}_{axis}")
    holder = {"coordinates": DM.Coordinates, "size": named("3Three_Dim_Size")}[quantity]
    assert tbox.value(prop, RDFS.range) == XSD.float
    assert tbox.value(prop, RDFS.domain) == holder
    assert (prop, RDF.type, OWL.FunctionalProperty) in tbox


def composite_properties(graph: Graph) -> set[URIRef]:
    """Properties that are transitive or the end of a chain, or imply or invert into one that is."""
    found = set(graph.subjects(RDF.type, OWL.TransitiveProperty))
    found |= set(graph.subjects(OWL.propertyChainAxiom, None))
    while True:
        more = {q for p in found for q in graph.objects(p, RDFS.subPropertyOf)}
        more |= {q for p in found for q in graph.objects(p, OWL.inverseOf)}
        more |= {q for p in found for q in graph.subjects(OWL.inverseOf, p)}
        if more <= found:
            return found
        found |= more


def test_owl_2_dl_only_simple_properties_are_restricted(tbox: Graph) -> None:
    composite = composite_properties(tbox)
    assert DM.isLocatedIn in composite
    assert DM.hasDirectPart not in composite
    for kind in SIMPLE_ONLY:
        assert not composite & set(tbox.subjects(RDF.type, kind))
    for end in (0, 2):
        assert not composite & {t[end] for t in tbox.triples((None, OWL.propertyDisjointWith, None))}
    for counted in (OWL.maxCardinality, OWL.qualifiedCardinality, OWL.maxQualifiedCardinality):
        assert not composite & {tbox.value(r, OWL.onProperty) for r in tbox.subjects(counted, None)}


def test_every_kind_of_axiom_is_there(tbox: Graph) -> None:
    for kind in (*SIMPLE_ONLY, OWL.TransitiveProperty, OWL.SymmetricProperty, OWL.AllDisjointClasses):
        assert (None, RDF.type, kind) in tbox, kind
    for axiom in (
        *(OWL.inverseOf, OWL.propertyChainAxiom, OWL.disjointWith, OWL.propertyDisjointWith),
        *(OWL.allValuesFrom, OWL.someValuesFrom, OWL.hasValue, OWL.oneOf, OWL.unionOf, OWL.complementOf),
        *(OWL.qualifiedCardinality, OWL.maxQualifiedCardinality, OWL.maxCardinality),
    ):
        assert (None, axiom, None) in tbox, axiom
    assert len([c for c in classes(tbox) if (c, OWL.equivalentClass, None) in tbox]) >= 10


@pytest.mark.parametrize(
    "word", ["Message", "Head", "Hair", "Garbage", "Mouse", "Wire", "Ruler", "Cover", "House"]
)
def test_synonyms_that_are_not_classes(tbox: Graph, word: str) -> None:
    assert named(word) not in classes(tbox)


def test_lists_hold_no_class_twice(tbox: Graph) -> None:
    for owner in tbox.subjects(RDF.type, OWL.AllDisjointClasses):
        members = list(Collection(tbox, tbox.value(owner, OWL.members)))
        assert len(members) == len(set(members))
