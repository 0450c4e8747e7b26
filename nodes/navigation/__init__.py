"""Navigation: occupancy grids, segmentation of rooms, and path planning. Pure."""
