"""The knowledge base: the ABox and its truth.

`semantic_map.py` is the core: one transaction in, one durable commit out. `planning.py` says which triples
change, `applier.py` has the reasoner take them in, and `map_state.py` is what holds then and can be asked.
Above it are `handlers/`: what is done for each verb of the wire.

Below it are `reasoner/` (what follows), `entities/` (what triples say of things), `relations/` (where things
are to one another), `storage/` (what survives a restart) and `documents/` (files in and out). `answers/` and
`sparql/` answer questions about it.
"""
