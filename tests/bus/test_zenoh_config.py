"""A user's Zenoh configuration is used, and errors that Zenoh ignores are reported."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.schemas import errors


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "zenoh.json5"
        path.write_text(text)
        return str(path)

    return write


def test_its_settings_apply_to_a_session(file):
    path = file("{ queries_default_timeout: 1234, /* JSON5 */ metadata: {name: 'robot'} }")
    bus.zenoh_config.require_sound(path, secure=True)
    config = bus.Network(own_config=path).as_config()
    assert config.get_json("queries_default_timeout") == "1234"
    assert config.get_json("scouting/multicast/enabled") == "false"  # as in every session of ours


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{ mode: 'peer' }", "sets mode"),
        ("{ id: 'abcd' }", "sets id"),
        ("{ listen: {endpoints: ['tcp/0.0.0.0:1']} }", "sets listen/endpoints.*use --listen"),
        ("{ connect: {endpoints: ['tcp/10.0.0.1:1']} }", "sets connect/endpoints.*use --connect"),
        ("{ transprt: 1 }", "unknown field `transprt`"),
        ("{", "not a Zenoh configuration"),
        ("{ transport: {link: {tls: {listen_certificate: '/none.pem'}}} }", "does not exist"),
        ("{ access_control: {rules: [], policies: [{rules: ['r'], subjects: ['s']}]} }", "not enabled"),
        (
            "{ access_control: {enabled: true, rules: [], policies: [{rules: ['r'], subjects: []}]} }",
            "uses r, which is not defined in rules",
        ),
        (
            "{ access_control: {enabled: true, policies: [{rules: [], subjects: ['s']}]} }",
            "uses s, which is not defined in subjects",
        ),
    ],
)
def test_settings_without_effect_are_rejected(file, text, told):
    with pytest.raises(errors.BadFile, match=told):
        bus.zenoh_config.require_sound(file(text), secure=False)


@pytest.mark.parametrize(
    "text",
    [
        "{ access_control: {enabled: true, default_permission: 'allow'} }",
        "{transport: {link: {tls: {enable_mtls: true}}}}",
    ],
)
def test_settings_made_from_the_keys_are_rejected_with_secure(file, text):
    bus.zenoh_config.require_sound(file(text), secure=False)
    with pytest.raises(errors.BadFile, match="which --secure creates"):
        bus.zenoh_config.require_sound(file(text), secure=True)


def test_a_missing_file_is_an_error(tmp_path):
    with pytest.raises(errors.BadFile, match="there is no file"):
        bus.zenoh_config.read(str(tmp_path / "none.json5"))


def test_mutual_tls_protects(file):
    assert bus.zenoh_config.is_protected(
        file("{transport: {link: {tls: {enable_mtls: true, root_ca_certificate: 'ca.pem'}}}}")
    )
    assert not bus.zenoh_config.is_protected(file("{}"))
