"""One front end for commands, and the reconciler that keeps map and scene in agreement.

`door/` turns commands into transactions, with `free_names.py`, `free_places.py`, `formats.py` and the
readers of `files/`;
`scene/reconcile.py` is the reconciler, a pure function; `scene/scene_view.py` is what is known of the scene.
"""
