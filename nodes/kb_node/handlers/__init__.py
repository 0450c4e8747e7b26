"""Handlers for each command of the knowledge base: a message in, a reply out.

`node.py` binds them to the wire.
"""
