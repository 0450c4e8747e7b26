import pytest

from semmap.schemas.endpoints import parse_endpoint
from semmap.schemas.errors import BadRequest


@pytest.mark.parametrize(
    ("text", "endpoint"),
    [
        ("tcp/127.0.0.1:7447", "tcp/127.0.0.1:7447"),
        ("127.0.0.1:7447", "tcp/127.0.0.1:7447"),
        ("robot.local:7447", "tcp/robot.local:7447"),
        ("tcp://robot:7447", "tcp/robot:7447"),
        ("tls://robot:7447/", "tls/robot:7447"),
        ("[::1]:7447", "tcp/[::1]:7447"),
        ("tcp/[fe80::1%eth0]:7447", "tcp/[fe80::1%eth0]:7447"),
        ("udp/10.0.0.1:7447#iface=eth0", "udp/10.0.0.1:7447#iface=eth0"),
        ("tcp/10.0.0.1:7447?rel=0#iface=eth0", "tcp/10.0.0.1:7447?rel=0#iface=eth0"),
        ("unixsock-stream//tmp/semmap.sock", "unixsock-stream//tmp/semmap.sock"),
        (" tcp/127.0.0.1:0 ", "tcp/127.0.0.1:0"),
    ],
)
def test_an_endpoint_is_understood_as_people_write_it(text, endpoint):
    assert parse_endpoint(text) == endpoint


@pytest.mark.parametrize(
    "text",
    ["", "robot", ":7447", "http://robot:7447", "tcp/127.0.0.1", "udp//", "tcp/robot:70000", "tcp/::1:7447",
     "tcp/a:1,tcp/b:2", "tcp:/robot", "unixpipe/", "tcp/robot:7447/x", 7447, ["tcp/a:1"], b"tcp/a:1"],
)  # fmt: skip
def test_another_text_is_no_endpoint(text):
    with pytest.raises(BadRequest, match="is not a valid endpoint; use tcp/HOST:PORT"):
        parse_endpoint(text)
