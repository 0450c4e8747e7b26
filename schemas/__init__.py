"""The messages of the system: pure data, known to every node and knowing none of them."""
