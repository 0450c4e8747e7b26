"""More than one robot: asked together, and mirrored into one SPARQL server."""
