"""Comparing sets of triples up to the labels of their blank nodes."""

from pyoxigraph import CanonicalizationAlgorithm, Dataset, RdfFormat, parse


def canonical(triples):
    """The triples with blank node labels that depend on nothing but the graph."""
    document = "".join(f"{s} {p} {o} .\n" for s, p, o in triples).encode()
    dataset = Dataset(parse(document, RdfFormat.N_TRIPLES))
    dataset.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return {str(quad) for quad in dataset}
