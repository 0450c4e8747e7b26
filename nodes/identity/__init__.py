"""Who is who: certificates with a name and a role, the authority that issues them, and the register of them.

`identity.py` is what a process needs to show who it is, and reads certificates without any library;
`authority.py` issues them (with the `keys` extra); `register.py` is the list of those that were issued.
"""

from semmap.nodes.identity.identity import SUPERVISOR as SUPERVISOR
from semmap.nodes.identity.identity import Identity as Identity
