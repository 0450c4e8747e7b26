"""Where a system is reached when nothing else is said."""

from __future__ import annotations

from typing import Final

DEFAULT_ENDPOINT: Final = "tcp/127.0.0.1:7447"
CONNECT_VARIABLE: Final = "SEMMAP_CONNECT"
"""The environment variable with another endpoint."""
CONFIG_VARIABLE: Final = "SEMMAP_ZENOH_CONFIG"
"""The environment variable with a Zenoh configuration file, for a system that was started with its own."""
IDENTITY_VARIABLE: Final = "SEMMAP_IDENTITY"
"""The environment variable with who somebody is."""
