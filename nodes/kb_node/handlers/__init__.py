"""What the knowledge base does for each verb: a message in, a reply out. `node.py` binds it to the wire."""
