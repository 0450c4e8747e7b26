"""Finding what a noun phrase describes: parsing it, resolving it against a map, and asking back."""
