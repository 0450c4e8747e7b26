import pytest
from msgspec import structs

from tests.kb_node.storage.journal.test_journal import commit


def at(seq, stamp_ns):
    return structs.replace(commit(seq), stamp_ns=stamp_ns)


@pytest.mark.parametrize(
    ("stamps", "asked", "found"),
    [
        ((10, 20, 30), (5, 10, 15, 30, 99), (0, 1, 1, 3, 3)),
        # set back from 50 to 20 after the third commit, and it passes 50 again with the sixth
        ((10, 40, 50, 20, 30, 60), (9, 10, 15, 20, 25, 30, 45, 55, 60), (0, 1, 1, 4, 4, 5, 5, 5, 6)),
        # set back before the first commit, for good
        ((100, 110, 1, 2), (0, 1, 2, 50, 105, 200), (0, 3, 4, 4, 4, 4)),
    ],
)
def test_times_are_found_after_a_clock_change(journal, stamps, asked, found):
    for seq, stamp_ns in enumerate(stamps, start=1):
        journal.append(at(seq, stamp_ns))
        journal.stamps.seq_at(stamp_ns)  # what came since is read the next time
    assert tuple(map(journal.stamps.seq_at, asked)) == found
