"""Fills a store on disk from N-Triples on stdin: `python -m nodes.kb_node.sparql.triples.filling PATH`.

Says on stdout how many triples the store has: fewer than came where two differ in the spelling of a number.
"""

from __future__ import annotations

import os
import sys

import pyoxigraph as ox


def main(path: str) -> None:
    """Read to the end, then say."""
    os.nice(5)  # the map itself comes first
    store = ox.Store(path)
    store.bulk_load(input=sys.stdin.buffer, format=ox.RdfFormat.N_TRIPLES)
    store.flush()
    print(len(store), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
