"""The processes of the system. They never import one another: they meet on the wire."""
