"""The token of the web page: from the environment, or generated."""

from __future__ import annotations

import re
import secrets
from typing import Final

from semmap.schemas import errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE

SHORTEST: Final = 16


def new_token(given: str = "") -> str:
    """Return the given token, or a random one. Raises BadRequest if it is too short."""
    if not given:
        return secrets.token_urlsafe(24)
    if len(given) < SHORTEST or not re.fullmatch(r"[A-Za-z0-9_.~-]*", given):
        raise errors.BadRequest(
            f"{WEB_TOKEN_VARIABLE} must have at least {SHORTEST} letters, digits, '-', '_', '.' or '~'"
        )
    return given
