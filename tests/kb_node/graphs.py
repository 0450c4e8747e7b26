"""Comparison of triple sets up to the labels of blank nodes."""

from pyoxigraph import CanonicalizationAlgorithm, Dataset, RdfFormat, parse


def canonical(triples):
    """Return the triples with blank node labels that depend only on the graph."""
    document = "".join(f"{s} {p} {o} .\n" for s, p, o in triples).encode()
    dataset = Dataset(parse(document, RdfFormat.N_TRIPLES))
    dataset.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return {str(quad) for quad in dataset}
