"""Episodes and times as text."""

from datetime import datetime

import pytest

from semmap.nodes.kb_node.answers.past.episodes import texts
from semmap.nodes.kb_node.answers.past.episodes.contents import list_contents
from semmap.schemas.episodes import Episode

NS = int(datetime(2020, 5, 17, 10, 3, 22).timestamp()) * 1_000_000_000
AT = "2020-05-17 10:03:22"


def episode(since, until=None, **fields):
    return Episode(subject="cup1", what="on table1", since=since, since_ns=NS, until=until, **fields)


@pytest.mark.parametrize(
    ("told", "text"),
    [
        (episode(7), f"since {AT} (commit 7)"),
        (episode(7, by="anna"), f"since {AT} (commit 7 by anna)"),
        (episode(None), f"since {AT} (live poses)"),
        (episode(0), f"since before the history begins ({AT})"),
        (episode(7, 8, until_ns=NS), f"from {AT} (commit 7) to {AT} (commit 8)"),
        (episode(7, until_ns=NS), f"from {AT} (commit 7) to {AT} (live poses)"),
    ],
)
def test_the_time_of_an_episode(told, text):
    assert texts.span(told) == text
    assert (texts.end(told) == "now") == text.startswith("since")


def test_a_time_of_today_has_no_date():
    noon = datetime.now().replace(hour=12, minute=0, second=1, microsecond=0)
    assert texts.clock(int(noon.timestamp()) * 1_000_000_000) == "12:00:01"


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (1, "1"),
        (5, "1, 2, 3, 4, 5"),
        (6, "1, 2, 3, 4, ... 1 more ..., 6"),
        (9, "1, 2, 3, 4, ... 4 more ..., 9"),
    ],
)
def test_at_most_five_texts_are_listed(count, text):
    assert texts.listed([str(number) for number in range(1, count + 1)]) == text


def test_a_long_duration_has_its_seconds():
    assert texts.lasted(119) == "119 s"
    assert texts.lasted(600) == "10 min (600 s)"


@pytest.mark.parametrize(
    ("asked", "names", "text"),
    [
        ("what", ("cup1", "cup2"), f"cup1 and cup2 were on table1 at {AT} (commit 7)"),
        ("what", ("cup1",), f"cup1 was on table1 at {AT} (commit 7)"),
        ("what", (), f"nothing was on table1 at {AT} (commit 7)"),
        ("who", (), f"no person was on table1 at {AT} (commit 7)"),
    ],
)
def test_the_contents_of_a_place(asked, names, text):
    found = list_contents(asked, names, "on table1", 7, NS)
    assert (found.asked, found.text, found.names, found.count) == (asked, text, names, len(names))
    assert found.evidence == tuple(
        Episode(subject=name, what="on table1", since=7, since_ns=NS) for name in names
    )
