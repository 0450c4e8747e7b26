"""The recorder's state: relations and the scene."""
