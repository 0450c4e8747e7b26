import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

import pytest

from semmap.nodes.supervisor import registry
from semmap.schemas import errors

HERE = "tcp/127.0.0.1:7801"


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """A registry in a temporary folder."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path / f"semmap-{os.getuid()}"


def entered(data, pid=None):
    return registry.entered(data=data, listen=HERE, reachable=HERE, pid=pid or os.getpid())


def test_a_system_is_listed_while_it_runs(tmp_path):
    assert registry.systems() == ()
    with entered(tmp_path / "a"), entered(tmp_path / "b"):
        assert [s.data for s in registry.systems()] == [f"{tmp_path}/a", f"{tmp_path}/b"]
    assert registry.systems() == ()


def test_a_system_whose_process_has_ended_is_not_listed(tmp_path):
    with (
        subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as process,
        ExitStack() as stack,
    ):
        stack.enter_context(entered(tmp_path, process.pid))
        assert len(registry.systems()) == 1
        process.kill()
        process.wait()
        assert registry.systems() == ()


def test_another_process_with_the_same_id_does_not_count(tmp_path, folder):
    with entered(tmp_path):
        file = folder / "systems.json"
        (system,) = registry.systems()
        file.write_text(file.read_text().replace(f'"{system.started}"', '"1"'))
        assert registry.systems() == ()


def test_many_at_the_same_time_lose_none(tmp_path):
    with ExitStack() as stack, ThreadPoolExecutor(8) as threads:
        for context in threads.map(lambda n: entered(tmp_path / str(n)), range(40)):
            stack.enter_context(context)
        assert len(registry.systems()) == 40


@pytest.mark.parametrize("content", ["", "{", '{"systems": [{"data": 1}]}', "[]"])
def test_an_invalid_file_is_replaced(tmp_path, folder, content):
    with entered(tmp_path):
        (folder / "systems.json").write_text(content)
        assert registry.systems() == ()
        with entered(tmp_path / "b"):
            assert [s.data for s in registry.systems()] == [f"{tmp_path}/b"]


def test_an_unwritable_registry_is_an_error(folder):
    folder.write_text("in the way")
    with pytest.raises(errors.Refused, match="cannot write the list"), entered(folder):
        pass
