"""Which relations are facts of the map, kept in step with where things are."""
