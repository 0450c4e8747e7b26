"""SPARQL over the map: what may be asked, what it means for the store, and who evaluates it where.

`text` and `footprint` look at queries, `dataset` and `consequences` keep the triples, `evaluation` answers,
`standing` remembers rows; `worker` with its `readers` is the process that does so, `service` its other end in
the knowledge base's node, `news` what the node publishes of it. Why a process: see `worker`.
"""
