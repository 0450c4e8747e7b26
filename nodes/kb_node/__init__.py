"""The knowledge base: it checks, stores and publishes the map.

`semantic_map.py` is the core: one transaction in, one durable commit out. `planning.py` computes the triples
that change, `applier.py` applies them to the reasoner, and `map_state.py` is the queryable state after the
last commit. `handlers/` implements the commands of the wire on top of it.

Below it are:

- `reasoner/`: inference
- `entities/`: entities as read from and written to triples
- `relations/`: spatial relations
- `storage/`: the journal and what a restart needs
- `documents/`: import and export of files

`answers/` and `sparql/` answer queries about the map.
"""
