"""Perception: from RGB-D frames to observations, and from those to commands.

In the order in which a frame passes through:

- frames: `frame_worker`, `frames`, `projection`, `cloud`; from files: `files/`
- one picture, taken apart: `segmentation/`, `furniture`, `segments`, `sights`
- all pictures of one moment (a look), put together: `pipeline` over `disputes`, `fusion`, `things`, `boxes`,
  and `recognition/`
- look after look: `association` over `matching` (`costs`, `overlap`, `occupancy`) and `tracks` (`votes`,
  `class_hierarchy`); `map_updates` says what the map is to be told
- on the wire: `node`, `segmented_cloud`
"""
