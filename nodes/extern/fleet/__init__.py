"""Several robots: joint queries, and mirroring to a SPARQL server."""
