"""Clients and interfaces: the command line, the Python clients, the page, MCP, ROS 2, and recordings."""
