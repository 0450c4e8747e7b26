"""Reference resolution: parse a noun phrase, resolve it against the map, and ask for clarification."""
