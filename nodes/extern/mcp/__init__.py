"""`semmap mcp`: the map for language-model agents, over the Model Context Protocol.

An agent reads the map by tools and, where that is allowed, changes it in two steps: `propose` and `commit`.
`server.py` alone knows the protocol's SDK; everything else is plain functions of a client of the system.
"""
