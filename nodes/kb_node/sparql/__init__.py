"""SPARQL over the map.

- `queries/` parses and evaluates queries.
- `triples/` keeps the triples, in memory or on disk, and a log of the commits.
- `standing_queries/` keeps the rows of standing queries and publishes their changes.
- `worker` is the process that follows the commits. It forks `readers`, which evaluate queries.
- `service` is the interface for the knowledge base's node. It sends queries over `lanes`.
- `protocol` defines the messages between these processes.

`worker` explains why separate processes are used.
"""
