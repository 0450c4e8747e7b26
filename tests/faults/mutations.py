"""Payloads that no client of ours would send, for every key: valid messages that are mutated.

`python -m tests.faults.mutations [COUNT] [SEED]` sends them to a system of its own and prints the results.
"""

from __future__ import annotations

import random
import sys
import tempfile
import threading
import time
import zlib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import zenoh
from msgspec import inspect

from semmap.nodes import bus
from semmap.schemas import bridge, codec, commands, errors, keys, scenes
from semmap.schemas.calls import Call
from tests.conftest import System, running

TIMEOUT_S = 900.0
"""Time-out of a reply: a check by owlrl takes half a minute of a core, and may wait for others."""
IN_FLIGHT = 16
_WORDS = ("--no-record",)
_NOT_SENT = frozenset({"clear", "step"})
"""Commands that are not sent, because they would empty the map or take minutes."""
_STRANGE: tuple[Any, ...] = (
    *(None, True, 0, -1, 2**63 - 1, -(2**63), 2**64 - 1, 1e308, -0.0, 5e-324, float("nan"), float("inf")),
    *(
        "",
        "\x00",
        "\x1b[2J",
        "a" * 300,
        "é" * 5000,
        "../../etc/passwd",
        "*",
        "**",
        "semmap/**",
        "$*",
        "?x",
        "@x",
    ),
    *("fridge1", "<urn:x>", '"1"^^<urn:y>', "'; DROP TABLE commits; --", "\u202e", "1e999", "-1", "NaN"),
    *([], {}, [[]], [None] * 50, {"a": {"b": {}}}, [[0.0, 0.0, 0.0]], b"", b"\xff" * 100),
)


def queries() -> dict[str, type[Call]]:
    """Return every key of a query, and the type of its message."""
    asked = {f"{keys.CMD}/{verb}": kind for verb, kind in commands.COMMANDS.items() if verb not in _NOT_SENT}
    asked |= {f"{keys.BRIDGE}/{verb}": kind for verb, kind in bridge.BRIDGE.items()}
    asked |= {
        f"{keys.SIM}/{kind.VERB}": kind
        for kind in vars(scenes).values()
        if isinstance(kind, type) and issubclass(kind, Call) and "VERB" in vars(kind)
    }
    return asked


def topics() -> dict[str, Any]:
    """Return every key of a publication, without wildcards, and the type of its message."""
    return {topic.key.replace("*", "x"): topic.message for topic in (*keys.TOPICS, keys.SEGMENTS)}


class Mutator:
    """Random mutated payloads, reproducible by the seed."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)

    def payload(self, kind: Any) -> bytes:
        """Return a payload that may be a valid message of type `kind`."""
        pick = self._random.choice
        content = self._value(inspect.type_info(kind), 0)
        for _ in range(self._random.choice((0, 1, 1, 2, 5))):
            content = self._broken(content)
        encode = pick((msgspec.msgpack.encode, msgspec.msgpack.encode, msgspec.json.encode))
        payload = encode(content)
        return pick(
            (self._same, self._same, self._same, self._flipped, self._cut, self._spliced, self._bomb)
        )(payload)

    def _value(self, info: inspect.Type, depth: int) -> Any:
        """Return data that resembles a message of that type."""
        choose = self._random
        match info:
            case inspect.Metadata(type=inner):
                return self._value(inner, depth)
            case inspect.UnionType(types=types):
                return self._value(choose.choice(types), depth)
            case inspect.StructType(fields=fields):
                return {
                    f.encode_name: self._value(f.type, depth + 1)
                    for f in fields
                    if f.required or choose.random() < 0.4
                }
            case inspect.TupleType(item_types=types):
                return [self._value(t, depth + 1) for t in types]
            case inspect.VarTupleType(item_type=item) | inspect.ListType(item_type=item):
                return [self._value(item, depth + 1) for _ in range(choose.choice((0, 1, 1, 3)))]
            case inspect.DictType(key_type=key, value_type=value):
                return {str(self._value(key, depth + 1)): self._value(value, depth + 1)}
            case inspect.LiteralType(values=values):
                return choose.choice(values)
            case inspect.FloatType():
                return choose.choice((0.0, 1.0, 0.5, choose.uniform(-5.0, 5.0)))
            case inspect.IntType():
                return choose.choice((0, 1, 7, 10_000))
            case inspect.StrType():
                return choose.choice(("fridge1", "Cup", "kitchen", "beer1", "isOn", "x", "dm:Chair", "a b"))
            case inspect.BytesType():
                return choose.choice(
                    (b"", b"<urn:a> <urn:b> <urn:c> .", b"{}", b'{"entities": []}', b"<rdf:RDF/>")
                )
            case inspect.BoolType():
                return choose.random() < 0.5
            case inspect.NoneType():
                return None
            case _:
                return choose.choice(_STRANGE)

    def _broken(self, content: Any) -> Any:
        """Return the data with one element changed, removed or added."""
        choose = self._random
        if isinstance(content, dict) and content and choose.random() < 0.9:
            key = choose.choice(list(content))
            match choose.randrange(5):
                case 0:
                    return {k: v for k, v in content.items() if k != key}
                case 1:
                    return {
                        **content,
                        choose.choice(("x", "verb", "id", "\x1b", "a" * 500)): choose.choice(_STRANGE),
                    }
                case 2:
                    return {**content, key: choose.choice(_STRANGE)}
                case _:
                    return {**content, key: self._broken(content[key])}
        if isinstance(content, list) and content and choose.random() < 0.8:
            place = choose.randrange(len(content))
            return [*content[:place], self._broken(content[place]), *content[place + choose.randrange(2) :]]
        return choose.choice(_STRANGE)

    def _same(self, payload: bytes) -> bytes:
        return payload

    def _flipped(self, payload: bytes) -> bytes:
        changed = bytearray(payload)
        for _ in range(self._random.choice((1, 1, 3, 20))):
            if changed:
                changed[self._random.randrange(len(changed))] ^= 1 << self._random.randrange(8)
        return bytes(changed)

    def _cut(self, payload: bytes) -> bytes:
        return payload[: self._random.randrange(len(payload) + 1)]

    def _spliced(self, payload: bytes) -> bytes:
        place = self._random.randrange(len(payload) + 1)
        return payload[:place] + self._random.randbytes(self._random.choice((1, 4, 100))) + payload[place:]

    def _bomb(self, payload: bytes) -> bytes:
        return self._random.choice(
            (
                zlib.compress(bytes(1 << 20)),
                b"\x91" * 100_000,
                b'{"a":' * 20_000,
                b"\xdd\xff\xff\xff\xff",
                b"\xdf\xff\xff\xff\xff",
                b"\xdc\xff\xff" + b"\x80" * 65_535,
                b"\xc6\xff\xff\xff\xff" + payload,
                b" " * 100_000 + b"{}",
            )
        )


@dataclass
class Outcome:
    """The result of a number of payloads."""

    sent: int = 0
    published: int = 0
    answered: Counter[str] = field(default_factory=Counter)
    """Counts by `ok` or the error code."""
    wrong: list[str] = field(default_factory=list)
    """Failures: no reply, an internal error, or an invalid text."""

    def __str__(self) -> str:
        answers = ", ".join(f"{count} {code}" for code, count in self.answered.most_common())
        return f"{self.sent} asked: {answers}; {self.published} published; {len(self.wrong)} wrong"


def send(endpoint: str, count: int, seed: int) -> Outcome:
    """Send `count` payloads to all keys."""
    outcome, mutator = Outcome(), Mutator(seed)
    asked, published = list(queries().items()), list(topics().items())
    free, lock = threading.Semaphore(IN_FLIGHT), threading.Lock()
    with bus.open_session(bus.Network(connect=(endpoint,))) as session:
        for number in range(count):
            if number % 4 == 3:
                key, kind = published[(number // 4) % len(published)]
                attachment = mutator.payload(scenes.CameraFrame) if "/camera/" in key else None
                session.put(key, mutator.payload(kind), attachment=attachment)
                outcome.published += 1
                continue
            key, call = asked[number % len(asked)]
            payload = mutator.payload(call)
            free.acquire()
            outcome.sent += 1
            _ask(session, key, payload, outcome, free, lock)
        for _ in range(IN_FLIGHT):
            free.acquire()
    return outcome


def _ask(
    session: Any, key: str, payload: bytes, outcome: Outcome, free: threading.Semaphore, lock: threading.Lock
) -> None:
    said: list[str] = []

    def on_reply(reply: zenoh.Reply) -> None:
        said.append(_told(reply))

    def on_end() -> None:
        with lock:
            told = said[0] if said else "no answer"
            outcome.answered[told.partition(":")[0]] += 1
            if told.startswith(("no answer", "internal", "unreadable")):
                outcome.wrong.append(f"{key} {payload[:300]!r}: {told}")
        free.release()

    handler = zenoh.handlers.Callback(on_reply, on_end)
    session.get(key, handler=handler, payload=payload, timeout=TIMEOUT_S)


def _told(reply: zenoh.Reply) -> str:
    if reply.ok is not None:
        return "ok"
    content = reply.err.payload.to_bytes()
    try:
        error = codec.decode(content, errors.ErrorMessage)
    except errors.BadRequest:
        return f"unreadable: {content[:200]!r}"
    if not error.text.strip() or len(error.text) > 2 * errors.LONGEST_TEXT or "Traceback" in error.text:
        return f"unreadable: {error.text[:200]!r}"
    return f"{error.code}: {error.text}"


def pids(system: System) -> dict[str, int]:
    """Return the process ids of the nodes."""
    with system.client() as client:
        return {node.node: node.pid for node in client.status().nodes if node.node in keys.NODES}


def main(count: int, seed: int) -> int:
    """Run it; returns 1 if a node died, or a reply was not as expected."""
    with (
        tempfile.TemporaryDirectory(prefix="semmap-mutations-") as folder,
        running(Path(folder, "d"), *_WORDS) as system,
    ):
        before, began_s = pids(system), time.monotonic()
        outcome = send(system.endpoint, count, seed)
        time.sleep(2.0)
        died = {node for node, pid in before.items() if pids(system).get(node) != pid}
        print("\n".join(outcome.wrong[:40]))
        print(
            f"{outcome}; {len(died)} nodes died ({', '.join(died)});"
            f" {time.monotonic() - began_s:.0f} s, seed {seed}"
        )
        with system.client() as client:
            for node in client.status().nodes:
                print(f"  {node.node}: {node.state}, {node.detail}; {node.last_error}")
    return 1 if died or outcome.wrong else 0


if __name__ == "__main__":
    words = [int(word) for word in sys.argv[1:]]
    sys.exit(main(words[0] if words else 20_000, words[1] if len(words) > 1 else random.randrange(1 << 30)))
