"""What a process shows of itself: its certificate, its key, and the authority that it trusts."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from msgspec import Struct

from semmap.schemas import errors

AUTHORITY: Final = "ca.crt"
SUPERVISOR: Final = "supervisor"
"""The name of `semmap up` itself."""


class Identity(Struct, frozen=True):
    """Paths of the files, and what the certificate says: a name, a role, and until when."""

    authority: str
    certificate: str
    key: str
    name: str
    role: str
    expires: datetime

    @classmethod
    def read(cls, path: Path | str) -> Identity:
        """The identity `DIR/NAME`: `DIR/NAME.crt`, `DIR/NAME.key` and `DIR/ca.crt`. Raises BadFile."""
        from semmap.nodes.identity import certificate  # most clients show none
        from semmap.schemas.roles import ROLES

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
                    f"there is no file {file}; an identity is DIR/NAME, made by: semmap keys add"
                )
        try:
            said = certificate.read(crt.read_bytes())
            key.open("rb").close()
        except ValueError as error:
            raise errors.BadFile(f"{crt} cannot be read: {error}") from None
        except OSError as error:
            raise errors.BadFile(f"{error.filename} cannot be read: {error.strerror}") from None
        if said.role not in ROLES:
            raise errors.BadFile(f"{crt} is not an identity: it says no role")
        return cls(str(authority.resolve()), str(crt.resolve()), str(key.resolve()), *said)

    def require_valid(self) -> None:
        """Raises NoAnswer for a certificate that has expired: nobody would answer to it."""
        if self.expires < datetime.now(UTC):
            raise errors.NoAnswer(
                f"the certificate of {self.name} expired on {self.expires:%Y-%m-%d %H:%M} UTC;"
                f" renew it where it was made: semmap keys renew {self.name}"
            )
