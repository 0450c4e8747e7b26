"""The certificates that an authority has issued: the list from which the router admits, and refuses."""

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
from semmap.schemas.roles import Role

FILE: Final = "identities.json"


class Member(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One to whom a certificate was issued; who is revoked never comes back under this name."""

    name: str
    role: Role
    serial: str
    """In hexadecimal."""
    expires: datetime
    revoked: bool = False


class Register(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All of them, and the hosts at which the router's certificate lets itself be found."""

    hosts: tuple[str, ...]
    members: dict[str, Member] = {}

    @property
    def admitted(self) -> tuple[Member, ...]:
        """Those that are not revoked."""
        return tuple(member for member in self.members.values() if not member.revoked)

    @classmethod
    def read(cls, folder: Path) -> Register:
        """That of a folder of keys. Raises BadFile where there is none."""
        path = folder / FILE
        try:
            return msgspec.json.decode(path.read_bytes(), type=codec.prepared(cls))
        except FileNotFoundError:
            raise errors.BadFile(
                f"{folder} is not a folder of keys; make one with: semmap keys init {folder}"
            ) from None
        except OSError as error:
            raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
        except msgspec.MsgspecError as error:
            raise errors.BadFile(f"{path} is malformed: {error}") from None

    def write(self, folder: Path) -> None:
        """Replace that of the folder as a whole, durably. Whoever changes it holds `lock_folder`."""
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
            file.write(msgspec.json.format(msgspec.json.encode(self)))
            file.flush()
            os.fsync(file.fileno())
        Path(file.name).replace(folder / FILE)


@contextlib.contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """While this is open no other process changes the folder of keys."""
    lock = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
    finally:
        os.close(lock)


class LiveRegister:
    """The register as it is now: read again whenever its file has changed. Owned by one thread."""

    def __init__(self, folder: Path) -> None:
        """Raises BadFile."""
        self._folder = folder
        self._seen = self._stamp()
        self._register = Register.read(folder)

    @property
    def now(self) -> Register:
        """The newest that could be read."""
        if (stamp := self._stamp()) != self._seen:
            try:
                self._register = Register.read(self._folder)
            except errors.BadFile:
                return self._register  # and look again
            self._seen = stamp
        return self._register

    def role_of(self, name: str) -> Role | None:
        """The role of somebody; None for one who is unknown or revoked."""
        member = self.now.members.get(name)
        return None if member is None or member.revoked else member.role

    def _stamp(self) -> tuple[int, int] | None:
        try:
            status = (self._folder / FILE).stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_ino
