"""Natural language generation: paragraphs about the contents of a map."""
