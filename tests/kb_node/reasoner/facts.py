"""Random facts."""

from hypothesis import strategies as st

from tests.kb_node.reasoner.graphs import CLASSES, DATA_PROPERTIES, LITERALS, OBJECT_PROPERTIES, triple

INDIVIDUALS = [f":i{n}" for n in range(7)]


def facts(individuals, classes, object_properties, data_properties, literals):
    individual = st.sampled_from(individuals)
    typed = st.builds(lambda s, c: f"{s} a {c}", individual, st.sampled_from(classes))
    linked = _links(individual, object_properties, individual)
    valued = _links(individual, data_properties, st.sampled_from(literals))
    compared = _links(individual, ["owl:sameAs", "owl:differentFrom"], individual)
    return st.one_of(typed, linked, linked, valued, compared).map(triple)


def _links(subjects, predicates, objects):
    return st.builds(lambda s, p, o: f"{s} {p} {o}", subjects, st.sampled_from(predicates), objects)


def prefixed(prefix, names):
    return [f"{prefix}:{name}" for name in names]


ANY_FACT = facts(
    INDIVIDUALS,
    prefixed("", CLASSES),
    prefixed("", OBJECT_PROPERTIES),
    prefixed("", DATA_PROPERTIES),
    LITERALS,
)
"""Facts for the schema of every construct (`graphs.EVERYTHING`)."""
