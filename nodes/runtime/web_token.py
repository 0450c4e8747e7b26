"""The token that opens the page: chosen by the environment, or one that nobody can guess."""

from __future__ import annotations

import re
import secrets
from typing import Final

from semmap.schemas import errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE

SHORTEST: Final = 16


def new_token(said: str = "") -> str:
    """The token that somebody chose, or one that nobody can guess. Raises BadRequest for one too short."""
    if not said:
        return secrets.token_urlsafe(24)
    if len(said) < SHORTEST or not re.fullmatch(r"[A-Za-z0-9_.~-]*", said):
        raise errors.BadRequest(
            f"{WEB_TOKEN_VARIABLE} must have at least {SHORTEST} letters, digits, '-', '_', '.' or '~'"
        )
    return said
