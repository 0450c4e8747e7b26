"""The router: the only listener of a host, which connects its nodes, clients and the routers of other hosts.

In a secure system it requires certificates and forwards only what the roles permit. `access.py` builds
Zenoh's access control from the table of roles, and `node.py` runs the router.
"""
