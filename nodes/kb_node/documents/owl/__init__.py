"""OWL's own syntaxes, and its axioms as RDF."""
