"""A private certificate authority: issues, renews and revokes certificates with a name and a role.

Only the router's certificate is valid for servers. Another certificate with that use could impersonate the
router.
"""

from __future__ import annotations

import functools
import ipaddress
import os
import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Concatenate, Final, ParamSpec

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID
from msgspec import structs

from semmap.nodes.identity.identity import AUTHORITY, SUPERVISOR
from semmap.nodes.identity.register import FILE, Member, Register, lock_folder
from semmap.schemas import errors, keys
from semmap.schemas.keys import ROUTER
from semmap.schemas.role_names import Role

OWN: Final = (ROUTER, SUPERVISOR, *keys.NODES)
"""The names of the system's own certificates."""
HOSTS: Final = ("localhost", "127.0.0.1")
DAYS: Final = 365
_AUTHORITY_DAYS: Final = 3650
_AUTHORITY_NAME: Final = "semmap"
_AUTHORITY_KEY: Final = "ca.key"
_FILE_SUFFIXES: Final = (".crt", ".key")
_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")
_HOST: Final = re.compile(r"(?=.{1,253}$)[A-Za-z0-9-]{1,63}(\.[A-Za-z0-9-]{1,63})*\.?")
_EARLY: Final = timedelta(minutes=5)
"""Certificates are valid from this long ago, because clocks differ."""

P = ParamSpec("P")
_Key = ec.EllipticCurvePrivateKey


def _locked(change: Callable[Concatenate[Path, P], Member]) -> Callable[Concatenate[Path, P], Member]:
    """Decorate a change of a folder of keys to hold its lock. Raises BadFile if there is no register."""

    @functools.wraps(change)
    def locked(folder: Path, /, *args: P.args, **options: P.kwargs) -> Member:
        Register.read(folder)
        with lock_folder(folder):
            return change(folder, *args, **options)

    return locked


def init(folder: Path, hosts: tuple[str, ...] = (), days: int = DAYS) -> Register:
    """Create the authority and the system's own certificates in `folder`.

    Raises Refused if it already has keys, BadRequest for an invalid host, BadFile if it cannot be written.
    """
    if (folder / FILE).exists() or (folder / AUTHORITY).exists():
        raise errors.Refused(f"{folder} already contains keys; to add one: semmap keys add NAME")
    hosts = tuple(dict.fromkeys((*HOSTS, *hosts)))
    for host in hosts:
        _host(host)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        folder.chmod(0o700)
    except OSError as error:
        raise errors.BadFile(f"cannot store keys in {folder}: {error.strerror}") from None
    key = _new_key()
    name = _subject(_AUTHORITY_NAME)
    certificate = (
        _builder(name, name, key.public_key(), _AUTHORITY_DAYS)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_key_usage(signs_certificates=True), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .sign(key, hashes.SHA256())
    )
    _write(folder, AUTHORITY, certificate.public_bytes(serialization.Encoding.PEM))
    _write(folder, _AUTHORITY_KEY, _key_bytes(key))
    register = Register(hosts=hosts)
    for own in OWN:
        register = _issued(folder, register, own, "node", days)
    register.write(folder)
    return register


@_locked
def add(folder: Path, name: str, role: Role, days: int = DAYS) -> Member:
    """Issue a certificate. Raises BadRequest for an invalid name, Refused for one that was used before."""
    register = Register.read(folder)
    if not _NAME.fullmatch(name):
        raise errors.BadRequest(
            f"invalid name '{name}'; use up to 64 letters, digits, '_', '.' and '-', beginning with a letter"
            " or a digit"
        )
    if Path(name).suffix.lower() in _FILE_SUFFIXES:
        raise errors.BadRequest(
            f"invalid name '{name}'; a name does not end in .crt or .key, the suffixes of its files;"
            f" use: {Path(name).stem}"
        )
    known = {other.lower(): member for other, member in register.members.items()}
    if (member := known.get(name.lower())) is not None:
        raise errors.Refused(
            f"{member.name} was revoked, and its old certificate would become valid again; use another name"
            if member.revoked
            else f"{member.name} already has a certificate ({member.role}); to renew it:"
            f" semmap keys renew {member.name}"
        )
    if f"{name}.crt".lower() == AUTHORITY:
        raise errors.BadRequest(f"'{name}' is the name of the authority; use another name")
    return _in_register(folder, register, name, role, days)


@_locked
def renew(
    folder: Path, name: str, hosts: tuple[str, ...] = (), days: int = DAYS, role: Role | None = None
) -> Member:
    """Issue a new key and certificate for a member, with another role if one is given.

    `hosts` are added to the router's certificate. Raises UnknownName; Refused for a revoked member, and for
    another role of one of the system's own.
    """
    register = Register.read(folder)
    member = _member(register, name)
    if member.revoked:
        raise errors.Refused(f"{name} was revoked; add a member with another name")
    if hosts and name != ROUTER:
        raise errors.BadRequest(
            f"only the router's certificate has hosts; use: semmap keys renew {ROUTER} --host"
        )
    if name in OWN and role not in (None, member.role):
        raise errors.Refused(f"{name} is part of the system; its role {member.role} cannot be changed")
    register = structs.replace(register, hosts=tuple(dict.fromkeys((*register.hosts, *hosts))))
    return _in_register(folder, register, name, role or member.role, days)


@_locked
def revoke(folder: Path, name: str) -> Member:
    """Revoke a certificate. Raises UnknownName; Refused for the system's own."""
    register = Register.read(folder)
    if name in OWN:
        raise errors.Refused(f"{name} is part of the system; to replace its key: semmap keys renew {name}")
    member = structs.replace(_member(register, name), revoked=True)
    structs.replace(register, members={**register.members, name: member}).write(folder)
    return member


def _member(register: Register, name: str) -> Member:
    if (member := register.members.get(name)) is None:
        hint = errors.did_you_mean(name, register.members)
        raise errors.UnknownName(f"no certificate was issued to '{name}'{hint}")
    return member


def _in_register(folder: Path, register: Register, name: str, role: Role, days: int) -> Member:
    register = _issued(folder, register, name, role, days)
    register.write(folder)
    return register.members[name]


def _issued(folder: Path, register: Register, name: str, role: Role, days: int) -> Register:
    """Write a key and a certificate, and return the register with it."""
    authority, authority_key = _authority(folder)
    key = _new_key()
    uses = [ExtendedKeyUsageOID.CLIENT_AUTH]
    builder = _builder(_subject(name, role), authority.subject, key.public_key(), days)
    if name == ROUTER:
        uses.append(ExtendedKeyUsageOID.SERVER_AUTH)
        builder = builder.add_extension(
            x509.SubjectAlternativeName([_host(host) for host in register.hosts]), critical=False
        )
    certificate = (
        builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_key_usage(signs_certificates=False), critical=True)
        .add_extension(x509.ExtendedKeyUsage(uses), critical=False)
        .add_extension(
            x509.AuthorityKeyIdentifier.from_issuer_public_key(authority_key.public_key()), critical=False
        )
        .sign(authority_key, hashes.SHA256())
    )
    _write(folder, f"{name}.key", _key_bytes(key))
    _write(folder, f"{name}.crt", certificate.public_bytes(serialization.Encoding.PEM))
    member = Member(
        name=name,
        role=role,
        serial=f"{certificate.serial_number:x}",
        expires=certificate.not_valid_after_utc,
    )
    return structs.replace(register, members={**register.members, name: member})


def _authority(folder: Path) -> tuple[x509.Certificate, _Key]:
    try:
        certificate = x509.load_pem_x509_certificate((folder / AUTHORITY).read_bytes())
        key = serialization.load_pem_private_key((folder / _AUTHORITY_KEY).read_bytes(), password=None)
    except OSError as error:
        raise errors.BadFile(f"the authority's {error.filename} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise errors.BadFile(f"the authority in {folder} is damaged: {error}") from None
    if not isinstance(key, _Key):
        raise errors.BadFile(f"the authority's key in {folder} is not an elliptic-curve key")
    return certificate, key


def _builder(
    subject: x509.Name, issuer: x509.Name, public_key: ec.EllipticCurvePublicKey, days: int
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(public_key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(datetime.now(UTC) - _EARLY)
        .not_valid_after(_end(days))
    )


def _end(days: int) -> datetime:
    return datetime.now(UTC) + timedelta(days=days)


def _subject(name: str, role: str = "") -> x509.Name:
    attributes = [x509.NameAttribute(NameOID.COMMON_NAME, name)]
    if role:
        attributes.append(x509.NameAttribute(NameOID.ORGANIZATIONAL_UNIT_NAME, role))
    return x509.Name(attributes)


def _host(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host.strip("[]")))
    except ValueError:
        if _HOST.fullmatch(host):
            return x509.DNSName(host)
        raise errors.BadRequest(f"invalid host name or address '{host}'") from None


def _key_usage(*, signs_certificates: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not signs_certificates,
        key_cert_sign=signs_certificates,
        crl_sign=signs_certificates,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


def _new_key() -> _Key:
    return ec.generate_private_key(ec.SECP256R1())


def _key_bytes(key: _Key) -> bytes:
    return key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )


def _write(folder: Path, name: str, content: bytes) -> None:
    """Replace a file; it is never readable by other users."""
    path = folder / f".{name}.new"
    path.unlink(missing_ok=True)
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(content)
    path.replace(folder / name)
