"""Import and export of documents in RDF and OWL syntaxes: ABoxes, and TBoxes with their imports."""
