"""Certificates are read without the certificate library, with the same result."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from datetime import UTC, datetime

import pytest
from cryptography import x509
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.identity import Identity, authority, certificate
from semmap.nodes.identity.register import LiveRegister, Register
from semmap.schemas import errors


def test_name_role_and_end_are_those_of_the_certificate(folder):
    for name, member in Register.read(folder).members.items():
        pem = (folder / f"{name}.crt").read_bytes()
        assert certificate.read(pem) == (name, member.role, member.expires)
        assert member.expires == x509.load_pem_x509_certificate(pem).not_valid_after_utc


def test_a_certificate_of_the_far_future_is_read(folder):
    """From 2050 on, times have another encoding."""
    authority.add(folder, "late", "viewer", days=365 * 40)
    assert certificate.read((folder / "late.crt").read_bytes()).expires.year > 2060


@given(st.binary(max_size=300))
def test_an_invalid_certificate_is_an_error(content):
    with pytest.raises(ValueError, match=r"certificate|truncated|unpack"):
        certificate.read(content)


@given(data=st.data())
def test_a_damaged_certificate_never_raises_anything_else(made_once, data):
    pem = bytearray((made_once / "vera.crt").read_bytes())
    at = data.draw(st.integers(30, len(pem) - 30))
    pem[at] = data.draw(st.integers(33, 126))
    with contextlib.suppress(ValueError):
        certificate.read(bytes(pem))


@pytest.mark.parametrize("path", ["vera", "vera.crt", "vera.key"])
def test_an_identity_is_named_by_folder_and_name(folder, path):
    identity = Identity.read(folder / path)
    assert (identity.name, identity.role) == ("vera", "viewer")
    assert identity.certificate == str(folder / "vera.crt")


@pytest.mark.parametrize("missing", ["vera.crt", "vera.key", "ca.crt"])
def test_a_missing_file_is_named(folder, missing):
    (folder / missing).unlink()
    with pytest.raises(errors.BadFile, match=missing):
        Identity.read(folder / "vera")


def test_an_expired_certificate_is_reported_before_any_request(folder):
    authority.add(folder, "old", "viewer", days=0)
    with pytest.raises(errors.NoAnswer, match=r"expired on \d{4}-.*semmap keys renew old"):
        Identity.read(folder / "old").require_valid()
    Identity.read(folder / "vera").require_valid()


def test_a_live_register_sees_what_is_added_and_revoked(folder):
    live = LiveRegister(folder)
    assert (live.role_of("vera"), live.role_of("bob")) == ("viewer", None)
    authority.add(folder, "bob", "operator")
    assert live.role_of("bob") == "operator"
    authority.revoke(folder, "vera")
    assert live.role_of("vera") is None
    before = live.now
    (folder / "identities.json").write_text("{")
    assert live.now is before  # an unreadable register changes nothing
    assert live.now.members["bob"].expires > datetime.now(UTC)


def test_neither_clients_nor_nodes_need_the_certificate_library(folder):
    program = (
        "import sys; sys.modules['cryptography'] = None\n"
        "import semmap.nodes.extern.cli.commands.lifecycle, semmap.nodes.extern.client\n"
        "import semmap.nodes.coordinator.node, semmap.nodes.router.node\n"
        "from semmap.nodes.identity import Identity\n"
        f"print(Identity.read({str(folder / 'vera')!r}).role)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, "viewer"), done.stderr
