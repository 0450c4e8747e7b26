"""What is asked of: the store of what is asserted and what follows, in memory and on disk."""
