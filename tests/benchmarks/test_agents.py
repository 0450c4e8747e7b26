"""The scripted tasks are done right, and by few characters."""

import asyncio
from collections import Counter

import pytest

from benchmarks.agents.__main__ import all_done, rows
from benchmarks.agents.tasks import TASKS, prepare


def test_there_are_seventy_tasks_of_eleven_kinds():
    assert len(TASKS) == 70
    assert set(Counter(task.kind for task in TASKS)) == {
        *("find", "understand", "count", "compare", "plan", "why", "possible", "when"),
        *("change", "refuse", "undo"),
    }  # fmt: skip


@pytest.mark.long
def test_every_task_is_done_right_and_reads_little(flat_map):
    with flat_map.client() as client:
        prepare(client)
        found = asyncio.run(asyncio.wait_for(all_done(client, flat_map.endpoint), 200))
    assert [one for one in found if one.fault] == []
    assert sum(one.characters for one in found) / len(found) < 1500
    assert max(one.calls for one in found) <= 3
    assert rows(found, 100_000, 5)[0].value == 1.0
