"""ROS 2 without ROS: the map as topics on rmw_zenoh's wire, and as MCAP files."""
