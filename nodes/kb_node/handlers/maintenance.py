"""Handlers for backup and compaction of the journal, run in a background thread."""

from __future__ import annotations

import re
import time
from concurrent.futures import Future, ThreadPoolExecutor
from datetime import datetime
from typing import Final

from semmap.nodes.kb_node.storage.backup import backup_parts
from semmap.nodes.kb_node.storage.compaction import compaction, leftovers
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors, wording
from semmap.schemas.backups import BackupPart
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commands import Backup, Compact
from semmap.schemas.replies import Compacted

_AGE: Final = re.compile(r"([1-9][0-9]{0,5})([hd])")
_SECONDS: Final = {"h": 3600, "d": 86_400}


class MaintenanceHandlers:
    """Reads and compacts the journal. The map itself does not change."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="keeping")
        if leftovers.exist(journal):
            self._executor.submit(leftovers.delete, journal)

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(Backup.answered_by(self.on_backup), Compact.answered_by(self.on_compact))

    def on_backup(self, query: Backup) -> Future[BackupPart]:
        """Return a part of a backup."""
        return self._executor.submit(backup_parts.read_part, self._journal, query.at)

    def on_compact(self, command: Compact) -> Future[Compacted]:
        """Compact the history; only one compaction runs at a time."""
        return self._executor.submit(self._compact, command)

    def _compact(self, command: Compact) -> Compacted:
        keep_ns, journal = _age_ns(command.keep), self._journal
        share = compaction.choose_range(journal, keep_ns=keep_ns, now_ns=time.time_ns())
        before = journal.size_bytes
        if share.commits and not command.dry_run:
            compaction.compact(journal, HistoryReader(journal), share.last)
        return Compacted(
            commits=share.commits,
            first=share.last + 1,
            bytes_before=before,
            bytes_after=journal.size_bytes,
            text=_describe(journal, share, command),
            dry_run=command.dry_run,
        )

    def close(self) -> None:
        """Start nothing more; running work is completed."""
        self._executor.shutdown(cancel_futures=True)


def _age_ns(text: str) -> int:
    """Return the nanoseconds of an age such as `12h` or `30d`. Raises BadRequest."""
    if (age := _AGE.fullmatch(text)) is None:
        raise errors.BadRequest(f"'{text}' is not an age; examples: 12h, 30d")
    return int(age[1]) * _SECONDS[age[2]] * 1_000_000_000


def _describe(journal: Journal, share: compaction.CompactedRange, command: Compact) -> str:
    first = share.last + 1
    begins = f"commit {first} of {datetime.fromtimestamp(journal.stamps.of(first) / 1e9):%Y-%m-%d %H:%M:%S}"
    if not share.commits:
        return f"no commit is older than {command.keep}: the history begins with {begins}"
    old = wording.counted(share.commits, "commit", "commits")
    if command.dry_run:
        return (
            f"{old} would become a snapshot, and the history would begin with {begins}; earlier commits"
            " could no longer be queried or undone"
        )
    return f"{old} became a snapshot: the history begins with {begins}"
