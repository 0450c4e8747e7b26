"""The stores that queries read: asserted and inferred triples, in memory and on disk."""
