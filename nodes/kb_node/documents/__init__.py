"""Documents in and out: RDF in every syntax, ABoxes and TBoxes."""
