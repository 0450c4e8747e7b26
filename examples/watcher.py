"""Print commits, and drinks that are added or removed, for a minute: python examples/watcher.py [SECONDS]."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import semmap

DRINKS = "SELECT ?drink { ?drink a dm:Drink }"


def watch_drinks(client: semmap.Client, seconds: float) -> None:
    """Print the rows of a standing query, then the rows that appear and disappear."""
    with client.watch(DRINKS, inferred=True) as standing:
        print("drinks:", *sorted(semmap.local_name(drink) for (drink,) in standing.rows), flush=True)
        try:
            for change in standing.changes(timeout=seconds):
                for (drink,) in change.appeared:
                    print(f"a drink came: {semmap.local_name(drink)}", flush=True)
                for (drink,) in change.disappeared:
                    print(f"a drink went: {semmap.local_name(drink)}", flush=True)
        except semmap.NoAnswer:
            pass  # no change within the timeout


def print_commits(commits: Iterator[semmap.Commit]) -> None:
    """Print every commit when it arrives."""
    try:
        for commit in commits:
            who = commit.agent or commit.source
            print(f"commit {commit.seq} by {who}: {commit.reason} ({' '.join(commit.names)})", flush=True)
    except semmap.NoAnswer:
        pass


def main() -> None:
    """Print commits and drinks concurrently until there is no change for `SECONDS`."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with semmap.connect(agent="watcher") as client, client.commits(timeout=seconds) as commits:
        drinks = threading.Thread(target=watch_drinks, args=(client, seconds))
        drinks.start()
        print_commits(commits)
        drinks.join()


if __name__ == "__main__":
    main()
