"""`make demo`: a tour through the commands, a drive, and a check of the resulting files.

All steps use the command line of systems on the loopback interface. The exit status is 0 if every step and
every resulting file is as expected.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from demo.checks import check_drive, check_export, check_picture, check_recording
from demo.drive import CAMERA, ROBOT, drive

HERE = Path(__file__).parent
DATA = HERE / "data"
EXPORT = HERE / "flat.owl"
RECORDING = HERE / "session.rrd"
DRIVE = HERE / "drive.rrd"
PICTURE = HERE / "scene.png"
_BIN = Path(sys.executable).parent
_SHOWN_LINES = 14
_WIDTH, _LONG = 110, 160
"""The width of wrapped lines, and the length from which lines are wrapped."""
_PATIENCE_S = 30.0


class Tour:
    """The steps on a running system."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint
        self._environment = {**os.environ, "SEMMAP_CONNECT": endpoint, "COLUMNS": f"{_WIDTH}"}
        self.failures: list[str] = []

    def heading(self, text: str) -> None:
        """Print a heading."""
        print(f"\n\033[1m# {text}\033[0m" if sys.stdout.isatty() else f"\n# {text}", flush=True)

    def do(self, *words: str, status: int = 0, holds: str = "") -> str:
        """Run and print `semmap WORDS`, record unexpected results, and return the output."""
        return self._show(["semmap", *words], status, holds)

    def zenoh(self, *words: str, holds: str = "") -> str:
        """Run the zenoh command line against the system."""
        return self._show(["zenoh", "--mode", "client", "--connect", self.endpoint, *words], 0, holds)

    def background(self, *words: str) -> subprocess.Popen[str]:
        """Start `semmap WORDS` in the background."""
        print(f"$ semmap {' '.join(words)} &", flush=True)
        command = [_BIN / "semmap", *words]
        return subprocess.Popen(command, env=self._environment, text=True, stdout=subprocess.PIPE)

    def ask(self, *words: str) -> object:
        """Return the JSON output of `semmap WORDS` without printing it."""
        command = [_BIN / "semmap", *words, "--format", "json"]
        run = subprocess.run(command, env=self._environment, capture_output=True, text=True)
        return json.loads(run.stdout) if run.returncode == 0 else None

    def until(self, what: str, condition: Callable[[], object]) -> None:
        """Wait until `condition()` holds, and record a failure after the timeout."""
        if _comes_to_hold(condition):
            print(f"({what})", flush=True)
        else:
            self.failures.append(f"timeout after {_PATIENCE_S:g} s: {what}")

    def agrees(self) -> bool:
        """Return whether every entity has its body, and all bodies at rest are committed."""
        status = self.ask("status")
        return isinstance(status, dict) and status["in_agreement"] is not None and not status["pending"]

    def pid(self, node: str) -> int:
        """Return the process id of a node."""
        status = self.ask("status")
        assert isinstance(status, dict)
        return next(int(n["pid"]) for n in status["nodes"] if n["node"] == node)

    @contextmanager
    def watching(self, *words: str, begins: str = "", shows: tuple[str, ...]) -> Iterator[None]:
        """Run a watching command during the block, and require a line with each of `shows`, in this order.

        The block starts after a line with `begins`, or after 2 s if the command prints none.
        """
        watch = self.background(*words)
        assert watch.stdout is not None
        lines: list[str] = []
        reader = Thread(target=_collect, args=(watch.stdout, lines))
        reader.start()
        if begins:
            _comes_to_hold(lambda: _in_order((begins,), lines))
        else:
            time.sleep(2.0)
        yield
        shown = _comes_to_hold(lambda: _in_order(shows, lines))
        watch.send_signal(signal.SIGINT)
        watch.wait()
        reader.join()
        print(f"$ {shlex.join(('semmap', *words))}")
        print(*lines, sep="\n", flush=True)
        if not shown:
            self.failures.append(f"{' '.join(words)} did not show {', '.join(shows)}")

    def _show(self, words: list[str], status: int, holds: str) -> str:
        print(f"$ {shlex.join(words)}", flush=True)
        command = [_BIN / words[0], *words[1:]]
        run = subprocess.run(command, env=self._environment, capture_output=True, text=True, cwd=HERE.parent)
        output = run.stdout + run.stderr
        lines = [line for line in output.splitlines() if line.strip()]
        for line in lines[:_SHOWN_LINES]:
            print(*textwrap.wrap(line, _WIDTH, max_lines=8) if len(line) > _LONG else [line], sep="\n")
        if len(lines) > _SHOWN_LINES:
            more = len(lines) - _SHOWN_LINES
            print(f"... and {more} more {'line' if more == 1 else 'lines'}")
        if run.returncode != status:
            self.failures.append(f"{' '.join(words)}: status {run.returncode}, expected {status}")
        if holds not in output:
            self.failures.append(f"{' '.join(words)}: output does not contain '{holds}'")
        return output


def _comes_to_hold(condition: Callable[[], object]) -> bool:
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        if condition():
            return True
        time.sleep(0.2)
    return False


def _collect(output: Iterable[str], lines: list[str]) -> None:
    for line in output:
        lines.append(line.rstrip())


def _in_order(texts: Sequence[str], lines: Sequence[str]) -> bool:
    """Return whether the texts occur in lines in this order."""
    rest = iter(list(lines))
    return all(any(text in line for line in rest) for text in texts)


def tour(t: Tour) -> None:
    """Run all commands except those for robots, which are in `demo.drive`."""
    t.heading("The state of the system, and the contents of the map")
    t.do("status")
    t.until("map and scene agree", t.agrees)
    t.do("tell", holds="The map has 9 places")
    t.do("list", "--class", "Furniture", holds="chair1")
    t.do("classes")

    t.heading("Add a beer on the kitchen table; that it is a drink is inferred")
    t.do(
        "add", "Beer", "beer7", "--at", "8.0", "2.3", "0.76", "--ref", "cold beer", "--alt", "lager", "--wait"
    )
    t.do("get", "beer7", holds="cold beer")
    t.do("list", "--class", "Drinkable", holds="beer7")
    t.do("infer", "beer7", holds="beer7 type Drinkable")
    t.do("explain", "beer7", "type", "Food", holds="beer7")

    t.heading("Natural language: descriptions, clarification questions, Italian, and a command")
    t.do("find", "something to drink", holds="beer7")
    t.do("find", "the book", holds="Which one: the book on the desk")
    t.do("find", "la tazza sulla scrivania", holds="cup1")
    request = "put the cold beer on the kitchen counter"
    t.do("understand", request, holds="Placing(Theme=beer7, Goal=counter1)")
    (frame,) = t.ask("understand", request)["frames"]  # type: ignore[index, call-overload]
    meant = {argument["role"]: argument["entity"] for argument in frame["arguments"]}
    t.do("update", meant["Theme"], "--at", "7.75", "0.45", "0.9")
    t.do("tell", meant["Goal"], holds="a cold beer")
    t.do("when", meant["Theme"], "isOn", "table1", holds="beer7 is no longer on table1; it was from commit")
    t.do("undo", holds="undid commit")
    t.do("when", meant["Theme"], "isOn", "table1", holds="2 times")

    t.heading("A chair with all defaults, and an update: omitted fields keep their values")
    t.do("add", "Chair", "--default", "--wait", holds="body: present")
    t.do("update", "beer7", "--ref", "warm beer", "--yaw", "0.5", holds="updated beer7")

    t.heading("Spatial relations: computed from poses and shapes, with explanations")
    t.do("list", "--on", "dining table", holds="beer7")
    t.do("relations", "beer7", holds="beer7 is on table1")
    t.do("explain", "apple1", "isInside", "bowl1", holds="within a hollow of bowl1")
    t.do("explain", "beer7", "isOn", "counter1", status=1, holds="beer7 is not on counter1")

    t.heading("Move the bowl with its contents, while a standing query watches the table")
    with t.watching("watch", "--on", "dining table", begins="watching", shows=("- bowl1", "+ bowl1")):
        t.do("update", "bowl1", "--at", "8.2", "1.3", "0", "--carry", holds="apple1 moved with bowl1")
        t.do("list", "--in", "bowl1", holds="apple1")
        t.do("undo", holds="undid commit")

    t.heading("Asserted and computed relations: a move retracts outdated assertions; wrong ones are noted")
    t.do("set", "beer7", "isOn", "table1")
    t.do("update", "beer7", "--at", "8.2", "1.6", "0", holds="retracted: beer7 was asserted to be on table1")
    t.do("set", "beer7", "isOn", "table1", holds="note: beer7 was asserted to be on table1; it stands")
    t.do("check", holds="note: beer7 was asserted to be on table1; it stands")
    t.do("update", "beer7", "--at", "8.0", "2.3", "0.76")
    t.do("unset", "beer7", "isOn", "table1")

    t.heading("Invalid changes are rejected with the reason, and nothing is changed")
    t.do("add", "Chiar", status=2, holds="did you mean")
    t.do("add", "Beer", "beer7", status=1, holds="taken")
    t.do("add", "Beer", "my beer", status=2, holds="valid name")
    t.do("add", "Beer", "--at", "nan", "0", "0", status=2)
    t.do("load", "demo/nonsense.ttl", status=1, holds="fridge1 cannot be both")
    t.do("remove", "beer8", status=1, holds="no entity is named 'beer8'")

    t.heading("Move a chair's body: when it comes to rest, its pose is committed")
    t.do("move", "chair1", "--at", "2.0", "1.2", "0.1", holds="moved chair1 to (2, 1.2, 0")
    t.do("get", "chair1", holds="scene/cli")

    t.heading("Check the consistency of the map")
    t.do("check", holds="consistent")

    t.heading("Load a scene in JSON and a HuRIC map; the format is detected from the content")
    t.do("load", "demo/picnic.json", holds="loaded 3")
    t.do("load", "demo/house.hrc", status=2, holds="Hair")
    t.do("load", "demo/house.hrc", "--skip-unknown", holds="hair_1")
    t.until("every entity has its body", t.agrees)

    t.heading("A file of commands")
    t.do("run", "demo/requests.txt", holds="orange7")

    t.heading("The same with the zenoh command line")
    t.zenoh("get", "-s", "semmap/cmd/get?name=beer7;format=json", "--decoder", "text", holds="warm beer")
    t.zenoh("get", "-s", "semmap/cmd/list", "-v", '{"class": "Drinkable"}', "--encoder", "msgpack",
            "--decoder", "msgpack", holds="beer7")  # fmt: skip
    t.zenoh(
        "put", "-k", "semmap/cmd/update", "-v", '{"name": "beer7", "ref": "my beer"}', "--encoder", "json"
    )
    t.until("the put was executed", lambda: t.ask("get", "beer7")["preferred_reference"] == "my beer")  # type: ignore[index]

    t.heading("Watch commits, and the changing result of a standing query")
    with (
        t.watching("watch", shows=("apple9",) * 2),
        t.watching(
            "watch",
            "--sparql",
            "SELECT ?f { ?f a dm:Fruit }",
            "--inferred",
            begins="watching",
            shows=("+", "-"),
        ),
    ):
        t.do("add", "Apple", "apple9", "--at", "1.3", "1.3", "0")
        t.do("remove", "apple9")

    t.heading("SPARQL")
    t.do("sparql", "SELECT ?s { ?s a dm:Seat }", "--inferred", holds="chair1")
    t.do("sparql", "INSERT DATA { :a a :b }", status=1, holds="update")

    t.heading("History, provenance and undo")
    t.do("history", "beer7", holds="add Beer beer7")
    t.do("diff", "1", "4", holds="beer7: added as Beer")
    t.do("list", "--class", "Beer", "--as-of", "1")
    t.do("last-seen", "apple9", holds="remove")
    t.do("add", "Vase", "vase9", "--at", "8.3", "2.2", "0.76")
    t.do("undo", holds="undid commit")
    t.do("get", "vase9", status=1)

    t.heading("A new TBox at run time: a file that lacks classes of the map is rejected")
    t.do("load", "--tbox", "demo/garden.ttl", status=1, holds="does not fit")

    t.heading("The entity list in the formats of other systems")
    t.do("list", "--class", "Beer", "--format", "lu4r", holds='"atom": "beer7"')
    t.do("list", "--class", "Beer", "--format", "legacy", holds="type_full")

    t.heading("Pause, step and resume time; reset all bodies; render the scene")
    t.do("step", status=1, holds="semmap pause")
    t.do("pause")
    t.do("step", "0.5")
    t.do("pause", "--off")
    t.do("reset")
    t.do("picture", str(PICTURE))

    t.heading("Kill the simulator: it is restarted, and all bodies are restored")
    os.kill(t.pid("sim_node"), signal.SIGKILL)
    time.sleep(1.0)
    t.until("map and scene agree again", t.agrees)

    t.heading("Export, clear and load: the map is the same as before")
    t.do("export", str(EXPORT), holds="wrote")
    check_export(t)
    t.until("every entity has its body", t.agrees)
    t.do("status")


def main() -> int:
    """Run both parts of the tour, each on its own system."""
    for left in (EXPORT, RECORDING, DRIVE, PICTURE):
        left.unlink(missing_ok=True)
    failures: list[str] = []
    commits = _on_a_system(tour, (), RECORDING, failures)
    driven = _on_a_system(drive, (*ROBOT, *CAMERA), DRIVE, failures)
    print("\n# Check the resulting files")
    check_recording(RECORDING, commits, failures)
    check_recording(DRIVE, driven, failures)
    check_drive(DRIVE, failures)
    check_picture(PICTURE, failures)
    for failure in failures:
        print(f"FAILED  {failure}")
    print("demo: " + (f"{len(failures)} steps failed" if failures else "all steps succeeded"))
    return 1 if failures else 0


def _on_a_system(
    part: Callable[[Tour], None], words: Sequence[str], recording: Path, failures: list[str]
) -> int:
    """Run a part of the tour on `semmap up WORDS` with a new map, and copy its recording.

    Returns the number of commits.
    """
    shutil.rmtree(DATA, ignore_errors=True)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    up = ["up", "--data", str(DATA), "--listen", endpoint, *words]
    print(f"$ semmap {' '.join(up)}", flush=True)
    system = subprocess.Popen([_BIN / "semmap", *up], stdout=subprocess.PIPE, text=True)
    t = Tour(endpoint)
    try:
        assert system.stdout is not None
        for line in system.stdout:
            print(line, end="", flush=True)
            if line.startswith("stop"):
                break
        else:
            raise SystemExit(system.wait() or 1)
        part(t)
        commits = int(t.ask("status")["commit"])  # type: ignore[index, call-overload]
    finally:
        t.heading("Stop")
        system.send_signal(signal.SIGINT)
        system.wait()
        failures += t.failures
    (recorded,) = sorted((DATA / "recordings").glob("*.rrd"))
    shutil.copy(recorded, recording)
    return commits


if __name__ == "__main__":
    sys.exit(main())
