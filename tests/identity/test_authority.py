"""Certificates are issued, renewed and revoked."""

from __future__ import annotations

import ipaddress
import stat
from datetime import UTC, datetime, timedelta

import pytest
from cryptography import x509
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from semmap.nodes.identity import authority
from semmap.nodes.identity.register import Register
from semmap.schemas import errors, keys


def loaded(folder, name):
    return x509.load_pem_x509_certificate((folder / f"{name}.crt").read_bytes())


def test_init_makes_the_authority_and_the_systems_own(folder):
    own = {"router", "supervisor", *keys.NODES}
    register = Register.read(folder)
    assert set(register.members) == own | {"vera"}
    assert {register.members[name].role for name in own} == {"node"}
    assert register.hosts == ("localhost", "127.0.0.1", "robot.local", "192.168.7.1")
    ca = loaded(folder, "ca")
    for name in register.members:
        certificate = loaded(folder, name)
        certificate.verify_directly_issued_by(ca)
        (common_name,) = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
        assert common_name.value == name
        assert f"{certificate.serial_number:x}" == register.members[name].serial


def test_only_the_routers_certificate_is_a_servers(folder):
    uses = {
        name: ExtendedKeyUsageOID.SERVER_AUTH
        in loaded(folder, name).extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
        for name in Register.read(folder).members
    }
    assert [name for name, server in uses.items() if server] == ["router"]
    said = loaded(folder, "router").extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert said.get_values_for_type(x509.DNSName) == ["localhost", "robot.local"]
    assert said.get_values_for_type(x509.IPAddress) == [
        ipaddress.ip_address("127.0.0.1"),
        ipaddress.ip_address("192.168.7.1"),
    ]


def test_other_users_cannot_read_it(folder):
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert {stat.S_IMODE(path.stat().st_mode) for path in folder.iterdir()} == {0o600}


def test_an_existing_folder_of_keys_is_not_replaced(folder):
    before = (folder / "ca.key").read_bytes()
    with pytest.raises(errors.Refused, match="already contains keys"):
        authority.init(folder)
    assert (folder / "ca.key").read_bytes() == before


@pytest.mark.parametrize("host", ["", "a b", "robot_1", "tls/robot1", "röbot"])
def test_an_invalid_host_leaves_no_keys(tmp_path, host):
    with pytest.raises(errors.BadRequest, match="invalid host name or address"):
        authority.init(tmp_path / "K", (host,))
    assert not (tmp_path / "K").exists()


@pytest.mark.parametrize("name", ["", "a/b", "a*", "@bob", "..", "-x", "a b", "x" * 65, "Zoë", "ca"])
def test_an_invalid_name_gets_no_certificate(folder, name):
    before = sorted(folder.iterdir())
    with pytest.raises(errors.BadRequest, match="name"):
        authority.add(folder, name, "viewer")
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("name", ["vera", "Vera", "router", "kb_node"])
def test_a_name_is_used_once(folder, name):
    with pytest.raises(errors.Refused, match="already has a certificate"):
        authority.add(folder, name, "admin")


def test_a_revoked_name_is_never_used_again(folder):
    """Its old certificate would become valid again, because the router checks names only."""
    authority.revoke(folder, "vera")
    register = Register.read(folder)
    assert "vera" not in {member.name for member in register.admitted}
    with pytest.raises(errors.Refused, match="revoked"):
        authority.add(folder, "vera", "viewer")
    with pytest.raises(errors.Refused, match="revoked"):
        authority.renew(folder, "vera")


def test_the_systems_own_cannot_be_revoked(folder):
    with pytest.raises(errors.Refused, match="is part of the system"):
        authority.revoke(folder, "router")


def test_a_renewed_certificate_is_another_one_of_the_same_name_and_role(folder):
    before, key = loaded(folder, "vera"), (folder / "vera.key").read_bytes()
    member = authority.renew(folder, "vera", days=7)
    after = loaded(folder, "vera")
    assert (after.subject, member.role) == (before.subject, "viewer")
    assert after.serial_number != before.serial_number
    assert (folder / "vera.key").read_bytes() != key
    left = after.not_valid_after_utc - datetime.now(UTC)
    assert timedelta(days=6, hours=23) < left <= timedelta(days=7)


def test_a_role_is_changed_with_the_certificate(folder):
    assert authority.renew(folder, "vera", role="operator").role == "operator"
    assert Register.read(folder).members["vera"].role == "operator"
    (unit,) = loaded(folder, "vera").subject.get_attributes_for_oid(NameOID.ORGANIZATIONAL_UNIT_NAME)
    assert unit.value == "operator"
    with pytest.raises(errors.Refused, match="its role node cannot be changed"):
        authority.renew(folder, "router", role="viewer")


def test_hosts_are_added_to_the_routers_certificate_only(folder):
    authority.renew(folder, "router", ("10.0.0.9",))
    said = loaded(folder, "router").extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert ipaddress.ip_address("10.0.0.9") in said.get_values_for_type(x509.IPAddress)
    assert Register.read(folder).hosts[-1] == "10.0.0.9"
    with pytest.raises(errors.BadRequest, match="only the router"):
        authority.renew(folder, "vera", ("10.0.0.9",))


def test_an_unknown_name_is_reported_with_similar_ones(folder):
    with pytest.raises(errors.UnknownName, match="did you mean vera"):
        authority.renew(folder, "verra")


def test_a_folder_without_keys_reports_how_to_create_them(tmp_path):
    with pytest.raises(errors.BadFile, match="semmap keys init"):
        authority.add(tmp_path, "bob", "viewer")


@pytest.mark.parametrize("name", ["ann.crt", "ann.key", "ann.KEY", "vera.crt", "ann.crt.key"])
def test_a_name_does_not_end_like_its_files(folder, name):
    bare = name.rpartition(".")[0]
    with pytest.raises(errors.BadRequest, match=rf"does not end in \.crt or \.key, .*; use: {bare}$"):
        authority.add(folder, name, "operator")
    assert not list(folder.glob(f"{name}.*"))
    with pytest.raises(errors.UnknownName, match=f"no certificate was issued to '{name}'"):
        authority.revoke(folder, name)
