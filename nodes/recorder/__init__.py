"""Records the scene, the knowledge graph and every commit with Rerun, into a file and to live viewers.

`map_relations.py` holds the relations of the map, and `drawing/` converts the state to Rerun archetypes.
`recording.py` writes the file, `commit_text.py` formats commits, and `replay.py` opens a recording in the
viewer.
"""
