"""SPARQL over the map: what may be asked, what it means for the store, and who evaluates it where.

- `queries/` looks at queries and answers them.
- `triples/` keeps the triples, in memory or on disk, and a log of the commits.
- `standing_queries/` remembers rows and tells what changes of them.
- `worker` is the process that follows the commits; the `readers` that it forks evaluate. `service` is their
  other end in the knowledge base's node, with the `lanes` on which it asks; they talk by `protocol`.

Why processes: see `worker`.
"""
