"""The knowledge base: the ABox and its truth.

`semantic_map.py` is the core (one transaction in, one commit out), over `reasoner/` (what follows),
`entities/` (what triples say of things), `storage/` (what survives) and `documents/` (what comes and goes as
files); `sparql/` is beside it.
"""
