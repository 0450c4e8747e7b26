"""The one listener of a secure system, to which everybody connects with a certificate.

It lets through what the role permits that the certificate says.

`access.py` makes Zenoh's access control from the table of roles; `node.py` runs it.
"""
