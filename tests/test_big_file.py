"""Loads a very large file: progress on stderr, live nodes, and bounded memory."""

from __future__ import annotations

import re
import subprocess

import psutil
import pytest

from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose
from tests.conftest import running

TRIPLES = 1_000_000
KB_A_TRIPLE = 4.0
"""Kilobytes of resident memory that a triple may cost the knowledge base, with its entities and all."""


def write(file, triples):
    """So many triples at least, of chairs; how many chairs."""
    with file.open("w") as out:
        count = i = 0
        while count < triples:
            at = Pose(position_m=(i % 300, i // 300, 0.0))
            for triple in entity_triples.describe(f"chair{i}", v.dm("Chair"), pose=at, preferred="chair"):
                out.write(" ".join(triple) + " .\n")
                count += 1
            i += 1
    return i


@pytest.mark.long
def test_a_file_of_very_many_triples(tmp_path):
    file = tmp_path / "many.nt"
    chairs = write(file, TRIPLES)
    with running(tmp_path / "data", "--abox", "none", "--no-sim", "--no-record") as system:
        with system.client() as client:
            pids = {n.node: n.pid for n in client.status().nodes}
        with system.spawned("load", str(file), stderr=subprocess.PIPE) as loading:
            said, told = loading.communicate()
        assert loading.returncode == 0, told
        assert f"loaded {chairs} entities" in said
        assert "semmap: loading many.nt: " in told
        assert re.search(r": \d{1,3}(,\d{3})+ triples read", told)  # once a second
        with file.open() as lines:
            assert f"{sum(1 for _ in lines):,} triples to check and write" in told
        with system.client() as client:
            status = client.status()
            assert status.entities == chairs
            assert {n.node: n.pid for n in status.nodes} == pids
        kb_node = psutil.Process(pids["kb_node"])
        assert kb_node.memory_info().rss < KB_A_TRIPLE * 1000 * TRIPLES
