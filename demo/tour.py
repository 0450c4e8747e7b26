"""`make demo`: systems on loopback, a tour through the commands, a drive, and a check of what they leave.

Everything goes through the command line, as a user would do it. Ends with 0 when every step did what was
expected of it and what it leaves is as it should be.
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
"""Characters of a line; longer ones than the second are sentences, and are wrapped."""
_PATIENCE_S = 30.0


class Tour:
    """A running system and what is done with it."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint
        self._environment = {**os.environ, "SEMMAP_CONNECT": endpoint, "COLUMNS": f"{_WIDTH}"}
        self.failures: list[str] = []

    def tell(self, text: str) -> None:
        """A word on what comes next."""
        print(f"\n\033[1m# {text}\033[0m" if sys.stdout.isatty() else f"\n# {text}", flush=True)

    def do(self, *words: str, status: int = 0, holds: str = "") -> str:
        """Run `semmap WORDS`, show it, and note it when it does not end as expected; its output."""
        return self._show(["semmap", *words], status, holds)

    def zenoh(self, *words: str, holds: str = "") -> str:
        """Run the zenoh command line against the system."""
        return self._show(["zenoh", "--mode", "client", "--connect", self.endpoint, *words], 0, holds)

    def background(self, *words: str) -> subprocess.Popen[str]:
        """Start `semmap WORDS` and go on."""
        print(f"$ semmap {' '.join(words)} &", flush=True)
        command = [_BIN / "semmap", *words]
        return subprocess.Popen(command, env=self._environment, text=True, stdout=subprocess.PIPE)

    def ask(self, *words: str) -> object:
        """What `semmap WORDS` answers in JSON, without showing it."""
        command = [_BIN / "semmap", *words, "--format", "json"]
        run = subprocess.run(command, env=self._environment, capture_output=True, text=True)
        return json.loads(run.stdout) if run.returncode == 0 else None

    def until(self, what: str, condition: Callable[[], object]) -> None:
        """Wait until `condition()` holds, and note it when it does not come to hold."""
        if _comes_to_hold(condition):
            print(f"({what})", flush=True)
        else:
            self.failures.append(f"waited {_PATIENCE_S:g} s in vain: {what}")

    def agrees(self) -> bool:
        """Return whether every entity has its body, and the map follows what rests; robots may drive."""
        status = self.ask("status")
        return isinstance(status, dict) and status["in_agreement"] is not None and not status["pending"]

    def pid(self, node: str) -> int:
        """The process of a node."""
        status = self.ask("status")
        assert isinstance(status, dict)
        return next(int(n["pid"]) for n in status["nodes"] if n["node"] == node)

    @contextmanager
    def watching(self, *words: str, begins: str = "", shows: tuple[str, ...]) -> Iterator[None]:
        """Watch meanwhile, and show what was seen: a line with each of `shows`, in this order.

        It has begun when a line with `begins` has come; some do not say so.
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
            self.failures.append(f"{' '.join(words)}: does not say '{holds}'")
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
    """Is each text in a line, and later ones in later lines?"""
    rest = iter(list(lines))
    return all(any(text in line for line in rest) for text in texts)


def tour(t: Tour) -> None:
    """Through the commands; those about a robot are in `demo.drive`."""
    t.tell("Who is there, and what is in the map")
    t.do("status")
    t.until("map and scene agree", t.agrees)
    t.do("tell", holds="The map has 9 places")
    t.do("list", "--class", "Furniture", holds="chair1")
    t.do("classes")

    t.tell("Add a beer on the kitchen table; it is a drink, though nobody said so")
    t.do(
        "add", "Beer", "beer7", "--at", "8.0", "2.3", "0.76", "--ref", "cold beer", "--alt", "lager", "--wait"
    )
    t.do("get", "beer7", holds="cold beer")
    t.do("list", "--class", "Drinkable", holds="beer7")
    t.do("infer", "beer7", holds="beer7 type Drinkable")
    t.do("explain", "beer7", "type", "Food", holds="beer7")

    t.tell("In words: find what is meant, be asked back, in Italian too; then do as one is told")
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

    t.tell("A chair with all defaults, and a change of it: omitted fields keep their values")
    t.do("add", "Chair", "--default", "--wait", holds="body: present")
    t.do("update", "beer7", "--ref", "warm beer", "--yaw", "0.5", holds="updated beer7")

    t.tell("Where things are: measured from poses and shapes, and explained")
    t.do("list", "--on", "dining table", holds="beer7")
    t.do("relations", "beer7", holds="beer7 is on table1")
    t.do("explain", "apple1", "isInside", "bowl1", holds="within a hollow of bowl1")
    t.do("explain", "beer7", "isOn", "counter1", status=1, holds="beer7 is not on counter1")

    t.tell("Carry the bowl away: what is in it goes along, and whoever watches the table is told")
    with t.watching("watch", "--on", "dining table", begins="watching", shows=("- bowl1", "+ bowl1")):
        t.do("update", "bowl1", "--at", "8.2", "1.3", "0", "--carry", holds="bowl1 carried apple1 along")
        t.do("list", "--in", "bowl1", holds="apple1")
        t.do("undo", holds="undid commit")

    t.tell("Said against seen: a move takes back what it makes wrong; what is wrong from the start is noted")
    t.do("set", "beer7", "isOn", "table1")
    t.do("update", "beer7", "--at", "8.2", "1.6", "0", holds="retracted: beer7 was said to be on table1")
    t.do("set", "beer7", "isOn", "table1", holds="note: beer7 was said to be on table1; it stands")
    t.do("check", holds="note: beer7 was said to be on table1; it stands")
    t.do("update", "beer7", "--at", "8.0", "2.3", "0.76")
    t.do("unset", "beer7", "isOn", "table1")

    t.tell("What cannot be is refused, with the reason, and nothing is changed")
    t.do("add", "Chiar", status=2, holds="did you mean")
    t.do("add", "Beer", "beer7", status=1, holds="taken")
    t.do("add", "Beer", "my beer", status=2, holds="valid name")
    t.do("add", "Beer", "--at", "nan", "0", "0", status=2)
    t.do("load", "demo/nonsense.ttl", status=1, holds="fridge1 cannot be both")
    t.do("remove", "beer8", status=1, holds="no entity is named 'beer8'")

    t.tell("Drag a chair: a hand takes the body, it comes to rest, the map follows")
    t.do("move", "chair1", "--at", "2.0", "1.2", "0.1", holds="moved chair1 to (2, 1.2, 0")
    t.do("get", "chair1", holds="scene/cli")

    t.tell("Is it all consistent?")
    t.do("check", holds="consistent")

    t.tell("Load a scene in JSON and a HuRIC map, the file told apart by its content")
    t.do("load", "demo/picnic.json", holds="loaded 3")
    t.do("load", "demo/house.hrc", status=2, holds="Hair")
    t.do("load", "demo/house.hrc", "--skip-unknown", holds="hair_1")
    t.until("every body stands", t.agrees)

    t.tell("A file of requests")
    t.do("run", "demo/requests.txt", holds="orange7")

    t.tell("The same from outside, with nothing but the zenoh command line")
    t.zenoh("get", "-s", "semmap/cmd/get?name=beer7;format=json", "--decoder", "text", holds="warm beer")
    t.zenoh("get", "-s", "semmap/cmd/list", "-v", '{"class": "Drinkable"}', "--encoder", "msgpack",
            "--decoder", "msgpack", holds="beer7")  # fmt: skip
    t.zenoh(
        "put", "-k", "semmap/cmd/update", "-v", '{"name": "beer7", "ref": "my beer"}', "--encoder", "json"
    )
    t.until("the put was executed", lambda: t.ask("get", "beer7")["preferred_reference"] == "my beer")  # type: ignore[index]

    t.tell("Watch changes as they happen, and the answer of a question as it changes")
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

    t.tell("Ask in SPARQL")
    t.do("sparql", "SELECT ?s { ?s a dm:Seat }", "--inferred", holds="chair1")
    t.do("sparql", "INSERT DATA { :a a :b }", status=1, holds="update")

    t.tell("The past: what was, who said so, and back again")
    t.do("history", "beer7", holds="add Beer beer7")
    t.do("diff", "1", "4", holds="beer7: added as Beer")
    t.do("list", "--class", "Beer", "--as-of", "1")
    t.do("last-seen", "apple9", holds="remove")
    t.do("add", "Vase", "vase9", "--at", "8.3", "2.2", "0.76")
    t.do("undo", holds="undid commit")
    t.do("get", "vase9", status=1)

    t.tell("Other classes at run time: a file that takes classes away that the map needs is refused")
    t.do("load", "--tbox", "demo/garden.ttl", status=1, holds="does not fit")

    t.tell("The entity list as other systems read it")
    t.do("list", "--class", "Beer", "--format", "lu4r", holds='"atom": "beer7"')
    t.do("list", "--class", "Beer", "--format", "legacy", holds="type_full")

    t.tell("Stop time, let it go on for a moment, let it run; put every body back; take a picture")
    t.do("step", status=1, holds="semmap pause")
    t.do("pause")
    t.do("step", "0.5")
    t.do("pause", "--off")
    t.do("reset")
    t.do("picture", str(PICTURE))

    t.tell("Kill the simulator: it comes back, and every body with it")
    os.kill(t.pid("sim_node"), signal.SIGKILL)
    time.sleep(1.0)
    t.until("map and scene agree again", t.agrees)

    t.tell("Export; clear; load it back: the same map as before")
    t.do("export", str(EXPORT), holds="wrote")
    check_export(t)
    t.until("every body stands", t.agrees)
    t.do("status")


def main() -> int:
    """Run both parts of the tour, each on a system of its own."""
    for left in (EXPORT, RECORDING, DRIVE, PICTURE):
        left.unlink(missing_ok=True)
    failures: list[str] = []
    commits = _on_a_system(tour, (), RECORDING, failures)
    driven = _on_a_system(drive, (*ROBOT, *CAMERA), DRIVE, failures)
    print("\n# Check what is left")
    check_recording(RECORDING, commits, failures)
    check_recording(DRIVE, driven, failures)
    check_drive(DRIVE, failures)
    check_picture(PICTURE, failures)
    for failure in failures:
        print(f"FAILED  {failure}")
    print("demo: " + (f"{len(failures)} steps failed" if failures else "all went well"))
    return 1 if failures else 0


def _on_a_system(
    part: Callable[[Tour], None], words: Sequence[str], recording: Path, failures: list[str]
) -> int:
    """Do a part of the tour on `semmap up WORDS` with a new map, and keep its recording; how many commits."""
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
        t.tell("Stop")
        system.send_signal(signal.SIGINT)
        system.wait()
        failures += t.failures
    (recorded,) = sorted((DATA / "recordings").glob("*.rrd"))
    shutil.copy(recorded, recording)
    return commits


if __name__ == "__main__":
    sys.exit(main())
