"""Access control of the running page: its paths, its WebSockets and the scene."""

from __future__ import annotations

import contextlib
import http.client
import re
import signal
from pathlib import Path
from urllib.parse import urlsplit

import psutil
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from tests.conftest import PATIENCE_S
from tests.page.conftest import serving

SOCKETS = ("/_nicegui_ws/socket.io/?EIO=4&transport=websocket", "/scene/some-page")


def ask(web, path, **headers):
    """Return status, headers and body of a GET request."""
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", web.port, timeout=30)) as connection:
        connection.request(
            "GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()}
        )
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()


@pytest.fixture(scope="module")
def cookie(web):
    status, headers, _ = ask(web, "/?" + urlsplit(web.url).query)
    assert status == 200
    return headers["set-cookie"].partition(";")[0]


@pytest.fixture(scope="module")
def paths(web, cookie):
    """The paths of the page, its assets, and its sockets."""
    page = ask(web, "/", cookie=cookie)[2].decode()
    found = sorted(set(re.findall(r'"(/_nicegui/[^"\s]+?\.(?:js|css|woff2?))"', page)))
    assert len(found) > 5, page[:2000]
    return ["/", *found, "/_nicegui_ws/socket.io/?EIO=4&transport=polling", "/scene/some-page/"]


def test_every_path_requires_the_cookie(web, cookie, paths):
    for path in paths:
        assert ask(web, path)[0] == 401, path
        assert ask(web, path, cookie=cookie, accept_encoding="gzip")[0] < 400, path


def test_every_path_rejects_other_origins_and_hosts(web, cookie, paths):
    for path in (*paths, "/?" + urlsplit(web.url).query):
        assert ask(web, path, cookie=cookie, origin="http://evil.example")[0] == 403, path
        assert ask(web, path, cookie=cookie, host=f"evil.example:{web.port}")[0] == 403, path


@pytest.mark.parametrize("path", SOCKETS)
def test_websockets_require_the_cookie_and_the_own_origin(web, cookie, path):
    def status(**headers):
        with pytest.raises(InvalidStatus) as caught:
            connect(f"ws://127.0.0.1:{web.port}{path}", additional_headers=headers, proxy=None)
        return caught.value.response.status_code

    assert status() == 401
    assert status(Cookie=cookie, Origin="http://evil.example") == 403
    assert status(Cookie=cookie, Host="evil.example") == 403
    subprotocols = ["viser-v1.1.1"] if "scene" in path else None
    with connect(
        f"ws://127.0.0.1:{web.port}{path}",
        additional_headers={"Cookie": cookie},
        origin=web.origin,
        subprotocols=subprotocols,
        proxy=None,
    ) as websocket:
        assert websocket.recv(timeout=30)


def test_the_page_listens_on_one_loopback_port_and_viser_on_none(web):
    listening = [
        c.laddr for c in psutil.Process(web.process.pid).net_connections("inet") if c.status == "LISTEN"
    ]
    assert [(at.ip, at.port) for at in listening] == [("127.0.0.1", web.port)]


@pytest.mark.parametrize(
    ("number", "folder"),
    [
        (signal.SIGTERM, "temporary"),
        (signal.SIGINT, "longer than the path of a socket " * 4),
    ],
    ids=["SIGTERM", "SIGINT, in a folder with a long path"],
)
def test_a_server_that_is_stopped_leaves_no_files(system, monkeypatch, tmp_path, number, folder):
    temporary = tmp_path / folder
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    with serving(system.endpoint) as web:
        assert [*temporary.iterdir()]
        web.process.send_signal(number)
        web.process.wait(PATIENCE_S)
    assert not [*temporary.iterdir()]


def test_the_socket_of_viser_is_private_to_the_user(web):
    unix = psutil.Process(web.process.pid).net_connections("unix")
    folders = {Path(c.laddr).parent for c in unix if "semmap-scene" in str(c.laddr)}
    assert folders
    assert all(folder.stat().st_mode & 0o077 == 0 for folder in folders)
