"""Commands as lists of steps: a grammar for clauses and noun phrases, and their meaning in the map."""
