import subprocess
import sys

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.web.server import WebConfig, run
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors


def test_a_port_in_use_is_reported_before_the_start():
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="peer")):
        taken = int(endpoint.rpartition(":")[2])
        with pytest.raises(errors.BadRequest, match=f"cannot listen on 127.0.0.1:{taken}: port in use"):
            run(WebConfig(network=bus.Network(connect=(endpoint,)), port=taken), print)


_IMPORTED = """
import sys
from semmap.nodes.extern.web.server import _hidden_modules
with _hidden_modules("aiohttp", "requests"):
    import nicegui
assert "aiohttp" not in sys.modules and "requests" not in sys.modules
import requests
with _hidden_modules("requests"):  # what is there already stays
    assert sys.modules["requests"] is requests
"""


def test_hidden_modules_are_not_imported_and_available_again():
    pytest.importorskip("nicegui")
    pytest.importorskip("requests")
    done = subprocess.run([sys.executable, "-c", _IMPORTED], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
