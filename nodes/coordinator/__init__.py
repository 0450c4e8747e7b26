"""One door for commands, and the keeper that keeps map and scene the same.

`door.py` turns commands into transactions, with `class_names.py`, `naming.py`, `formats.py` and the readers
of `files/`; `keeper.py` is the reconciler, a pure function; `scene_view.py` is what is known of the scene.
"""
