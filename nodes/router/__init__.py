"""The one listener of a host, where its nodes meet and clients join; it connects to routers of other hosts.

In a secure system everybody shows it a certificate, and it lets through what their role permits.

`access.py` makes Zenoh's access control from the table of roles; `node.py` runs it.
"""
