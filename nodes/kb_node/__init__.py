"""The knowledge base: the ABox and its truth.

`semantic_map.py` is the core (one transaction in, one commit out), over `reasoner/` (what follows),
`entities/` (what triples say of things), `relations/` (where things are to one another), `storage/` (what
survives a restart) and `documents/` (files in and out). `answers/` and `sparql/` answer questions about it.
"""
