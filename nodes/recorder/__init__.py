"""Records the scene, the knowledge graph and every commit with Rerun, into a file and to live viewers.

`state/` holds what is known of relations and of the scene; `drawing/` what of it is drawn, and how;
`recording.py` is the file, `commit_text.py` what it says of commits; `replay.py` opens it in the viewer.
"""
