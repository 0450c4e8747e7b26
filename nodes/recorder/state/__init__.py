"""What a recording has to show: the map and the scene."""
