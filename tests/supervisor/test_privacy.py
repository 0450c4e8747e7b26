from __future__ import annotations

import stat

from semmap.nodes.supervisor.privacy import make_private


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_files_are_private_to_the_user(tmp_path):
    data = tmp_path / "d"
    (data / "logs").mkdir(parents=True)
    ours = [
        data / "journal.sqlite",
        data / "journal.sqlite-wal",
        data / "settings.json",
        data / "logs" / "a.log",
    ]
    for path in ours:
        path.touch(0o644)
    another = data / "thesis.tex"
    another.touch(0o644)
    linked = tmp_path / "elsewhere"
    linked.touch(0o644)
    (data / "logs" / "link").symlink_to(linked)
    for path in (data, data / "logs"):
        path.chmod(0o755)
    make_private(data)
    assert {mode(path) for path in ours} == {0o600}
    assert {mode(data), mode(data / "logs")} == {0o700}
    assert (mode(another), mode(linked)) == (0o644, 0o644)  # owned by the user, not by semmap


def test_a_new_folder_is_private(tmp_path):
    make_private(tmp_path / "a" / "b")
    assert mode(tmp_path / "a" / "b") == 0o700
