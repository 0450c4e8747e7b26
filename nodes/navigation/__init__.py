"""Plans for robots that drive: occupancy grids, rooms cut out of them, and ways; pure."""
