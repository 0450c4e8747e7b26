"""The identity of a process: its certificate, its key, and the authority that it trusts."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from msgspec import Struct

from semmap.schemas import errors

AUTHORITY: Final = "ca.crt"
SUPERVISOR: Final = "supervisor"
"""The name of `semmap up`."""


class Identity(Struct, frozen=True):
    """Paths of the files, and the certificate's name, role and expiry."""

    authority: str
    certificate: str
    key: str
    name: str
    role: str
    expires: datetime

    @classmethod
    def read(cls, path: Path | str) -> Identity:
        """Read the identity `DIR/NAME`: `DIR/NAME.crt`, `DIR/NAME.key` and `DIR/ca.crt`. Raises BadFile."""
        from semmap.nodes.identity import certificate  # most clients show none
        from semmap.schemas.role_names import ROLES

        path = Path(path).expanduser()
        path = path.with_suffix("") if path.suffix in (".crt", ".key") else path
        crt, key, authority = (
            path.with_name(f"{path.name}.crt"),
            path.with_name(f"{path.name}.key"),
            path.with_name(AUTHORITY),
        )
        for file in (crt, key, authority):
            if not file.is_file():
                raise errors.BadFile(
                    f"there is no file {file}; an identity is DIR/NAME; to create one: semmap keys add"
                )
        try:
            found = certificate.read(crt.read_bytes())
            key.open("rb").close()
        except ValueError as error:
            raise errors.BadFile(f"{crt} cannot be read: {error}") from None
        except OSError as error:
            raise errors.BadFile(f"{error.filename} cannot be read: {error.strerror}") from None
        if found.role not in ROLES:
            raise errors.BadFile(f"{crt} is not an identity: the certificate has no role")
        return cls(str(authority.resolve()), str(crt.resolve()), str(key.resolve()), *found)

    def require_valid(self) -> None:
        """Raise NoAnswer for an expired certificate, which no node would accept."""
        if self.expires < datetime.now(UTC):
            raise errors.NoAnswer(
                f"the certificate of {self.name} expired on {self.expires:%Y-%m-%d %H:%M} UTC;"
                f" renew it where it was issued: semmap keys renew {self.name}"
            )
