"""ROS 2 without ROS: the map as topics in the protocol of rmw_zenoh, and as MCAP files."""
