"""The commands as messages: `client.send(Add("Cup"))` is the same as `client.add("Cup")`."""

from semmap.schemas.commands import *  # noqa: F403
from semmap.schemas.commands import __all__ as __all__
