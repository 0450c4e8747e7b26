"""The outside of the system: the command line, the Python clients, the codecs for the zenoh CLI."""
