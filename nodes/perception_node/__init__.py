"""Perception: from RGB-D frames to observations, and from observations to commands.

The subpackages, in the order in which a frame passes through them:
- `input/` reads frames from cameras and files, and projects them to point clouds.
- `segmentation/` splits one cloud into planes and objects.
- `views/` combines the segments of all cameras of one moment to things.
- `recognition/` assigns classes and estimates complete boxes. `pipeline` combines these steps.
- `fitting/` aligns the models of classes with things.
- `tracking/` associates observations with entities and computes updates of the map.
- `node` is the process on the network.
"""
