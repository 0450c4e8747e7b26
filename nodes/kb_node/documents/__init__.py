"""Documents in and out, in the syntaxes of RDF and OWL: ABoxes, and TBoxes with what they import."""
