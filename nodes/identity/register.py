"""The register of issued certificates, by which the router admits or rejects clients."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Final

import msgspec

from semmap.schemas import codec, errors
from semmap.schemas.role_names import Role

FILE: Final = "identities.json"


class Member(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The owner of a certificate; the name of a revoked one cannot be used again."""

    name: str
    role: Role
    serial: str
    """In hexadecimal."""
    expires: datetime
    revoked: bool = False


class Register(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All members, and the hosts in the router's certificate."""

    hosts: tuple[str, ...]
    members: dict[str, Member] = {}

    @property
    def admitted(self) -> tuple[Member, ...]:
        """The members that are not revoked."""
        return tuple(member for member in self.members.values() if not member.revoked)

    @classmethod
    def read(cls, folder: Path) -> Register:
        """Read the register of a folder of keys. Raises BadFile if there is none."""
        path = folder / FILE
        try:
            return msgspec.json.decode(path.read_bytes(), type=codec.prepared(cls))
        except FileNotFoundError:
            raise errors.BadFile(
                f"{folder} is not a folder of keys; create one with: semmap keys init {folder}"
            ) from None
        except OSError as error:
            raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
        except msgspec.MsgspecError as error:
            raise errors.BadFile(f"{path} is malformed: {error}") from None

    def write(self, folder: Path) -> None:
        """Replace the register of a folder atomically and durably; the caller holds `lock_folder`."""
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
            file.write(msgspec.json.format(msgspec.json.encode(self)))
            file.flush()
            os.fsync(file.fileno())
        Path(file.name).replace(folder / FILE)


@contextlib.contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Lock the folder of keys: no other process changes it while the context is open."""
    lock = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
    finally:
        os.close(lock)


class LiveRegister:
    """The current register, read again whenever its file has changed. Owned by one thread."""

    def __init__(self, folder: Path) -> None:
        """Raises BadFile."""
        self._folder = folder
        self._seen = self._stamp()
        self._register = Register.read(folder)

    @property
    def now(self) -> Register:
        """The newest register that could be read."""
        if (stamp := self._stamp()) != self._seen:
            try:
                self._register = Register.read(self._folder)
            except errors.BadFile:
                return self._register  # try again later
            self._seen = stamp
        return self._register

    def role_of(self, name: str) -> Role | None:
        """Return the role of a member; None for one that is unknown or revoked."""
        member = self.now.members.get(name)
        return None if member is None or member.revoked else member.role

    def _stamp(self) -> tuple[int, int] | None:
        try:
            status = (self._folder / FILE).stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_ino
