"""Identities: certificates with a name and a role, the authority that issues them, and their register.

`identity.py` has the files that identify a process, and reads certificates without any library.
`authority.py` issues certificates (with the extra `keys`). `register.py` lists the issued ones.
"""

from semmap.nodes.identity.identity import SUPERVISOR as SUPERVISOR
from semmap.nodes.identity.identity import Identity as Identity
