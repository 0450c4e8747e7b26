"""`semmap mcp`: the map for language-model agents, over the Model Context Protocol.

An agent reads the map with tools and, where that is allowed, changes it in two steps: `propose` and `commit`.
Only `server.py` and `http.py` use the SDK of the protocol; the other modules are functions of a client.
"""
