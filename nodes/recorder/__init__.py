"""Records the scene, the knowledge graph and every commit with Rerun, into a file and to live viewers.

`map_state.py` and `scene_state.py` are what is known, `figures.py` and `graph.py` what of it is drawn,
`stage.py` what is drawn already; `geometry.py`, `commit_text.py` and `blueprint.py` say how it looks;
`recording.py` is the file; `replay.py` opens it and reads it back.
"""
