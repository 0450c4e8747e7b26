"""Who changes what, and the drinks that come and go, for a minute: python examples/watcher.py [SECONDS]."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import semmap

DRINKS = "SELECT ?drink { ?drink a dm:Drink }"


def watch_drinks(client: semmap.Client, seconds: float) -> None:
    """A standing query: its rows now, then which appear and disappear, and with which commit."""
    with client.watch(DRINKS, inferred=True) as standing:
        print("drinks:", *sorted(semmap.local_name(drink) for (drink,) in standing.rows), flush=True)
        try:
            for change in standing.changes(timeout=seconds):
                for (drink,) in change.appeared:
                    print(f"a drink came: {semmap.local_name(drink)}", flush=True)
                for (drink,) in change.disappeared:
                    print(f"a drink went: {semmap.local_name(drink)}", flush=True)
        except semmap.NoAnswer:
            pass  # nothing happened for that long


def tell(commits: Iterator[semmap.Commit]) -> None:
    """Every commit, as it comes."""
    try:
        for commit in commits:
            who = commit.agent or commit.source
            print(f"commit {commit.seq} by {who}: {commit.reason} ({' '.join(commit.names)})", flush=True)
    except semmap.NoAnswer:
        pass


def main() -> None:
    """Both at once, until nothing happens for some time."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with semmap.connect(agent="watcher") as client, client.commits(timeout=seconds) as commits:
        drinks = threading.Thread(target=watch_drinks, args=(client, seconds))
        drinks.start()
        tell(commits)
        drinks.join()


if __name__ == "__main__":
    main()
