"""Two parts of a system, each with its own supervisor, linked by their routers."""

import subprocess
import sys
from pathlib import Path

from semmap.nodes.extern.client import connect
from tests.conftest import PATIENCE_S, free_endpoint, running, until

SEMMAP = Path(sys.executable).with_name("semmap")


def heard(process, word):
    """Return the output of a process until a line has `word`."""
    lines = []
    for line in process.stdout:
        lines.append(line)
        if word in line:
            return lines
    raise AssertionError(f"no {word}: {lines}")


def test_parts_wait_for_one_another_work_together_and_end_alone(tmp_path):
    lab, robot = free_endpoint(), free_endpoint()
    words = ["--data", tmp_path / "robot", "--only", "sim", "--world", "empty", "--listen", robot]
    command = [SEMMAP, "up", *words, "--connect", lab]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as far:
        try:
            said = heard(far, "router")
            assert f"waiting for {lab}" in said[-1]
            assert not any(line.startswith("map ") for line in said)  # which is elsewhere
            with running(
                tmp_path / "lab", "--only", "kb,coordinator", "--abox", "none", endpoint=lab
            ) as near:
                assert any("linked to 1 other router" in line for line in heard(far, "stop "))
                with connect(robot) as client:
                    assert "present" in client.add("Cup", "cup1", at=(1.0, 1.0, 0.0), wait=True).text
                    nodes = sorted(node.node for node in client.status().nodes if node.state == "ready")
                assert nodes == ["coordinator", "kb_node", "router", "sim_node"]
                subprocess.run([SEMMAP, "down", "--data", tmp_path / "robot"], check=True, timeout=PATIENCE_S)
                assert far.wait(PATIENCE_S) == 0
                with near.client() as client:
                    client.add("Cup", "cup2", at=(2.0, 1.0, 0.0))
                    until(lambda: client.status().in_agreement is None, "no simulator is listed")
                assert near.process.poll() is None
        finally:
            far.terminate()
