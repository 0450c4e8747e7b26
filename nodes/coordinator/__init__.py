"""The coordinator: the entry point for commands, and the reconciler that keeps map and scene in agreement.

`commands/` turns commands into transactions, `scene/` sends commands to the simulator, and `reconciler/`
compares map and scene. `access/` decides which client may do what.

`live/` receives the poses of tracked entities, and `frames/` converts positions between frames.
`scheduler.py` orders the changes, and `node.py` connects all of it to Zenoh.
"""
