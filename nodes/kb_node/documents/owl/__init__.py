"""The OWL syntaxes, and OWL axioms as RDF."""
