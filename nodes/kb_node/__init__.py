"""The knowledge base: the ABox and its truth.

`semantic_map.py` is the core (one transaction in, one commit out), over `reasoner/` (what follows),
`journal.py` (what survives), `rdf_files.py`, `documents.py` and `loading.py` (what comes and goes as files).
"""
