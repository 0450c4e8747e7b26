"""SPARQL over the map: what may be asked, what it means for the store, and who evaluates it where.

`text` and `footprint` look at queries, `dataset` and `consequences` keep the triples, `evaluation` answers,
`standing` remembers rows. `worker` is the process that follows the commits into its `log`; the `readers` that
it forks evaluate, one of them for the `lookout` that minds the standing queries. `service` is their other end
in the knowledge base's node, with the `lanes` on which it asks; `news` is what the node publishes of it. Why
processes: see `worker`.
"""
