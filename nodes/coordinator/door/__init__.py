"""The door: a command in, a transaction to the knowledge base, a reply out.

It validates, resolves names, and leaves consistency to the knowledge base. It knows no Zenoh. Each verb is a
dialogue with the knowledge base (`dialogues.py`): `changing.py` add, update, remove, clear; `loading.py`
load; `undoing.py` undo. They share `committing.py`, and `known_map.py`, the map as the coordinator knows it.
"""

from semmap.nodes.coordinator.door.door import Door as Door
