import contextlib
import gc
import math
import subprocess
import sys
import zlib
from typing import Any

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.schemas import codec, errors
from semmap.schemas.bridge import Recall, SnapshotQuery, TakeBack
from semmap.schemas.commands import COMMANDS, Add, Check, List, Load, Remove, StepOnce, Undo
from semmap.schemas.commits import Departed, Snapshot, Transaction
from semmap.schemas.entities import Pose
from tests.schemas import messages


@pytest.mark.parametrize("kind", messages.TYPES, ids=lambda kind: kind.__name__)
@settings(max_examples=5, deadline=None)
@given(st.data())
def test_what_is_decoded_is_what_was_encoded(kind, data):
    message = data.draw(messages.of(kind))
    assert codec.decode(codec.encode(message), kind) == message
    assert codec.decode(codec.encode_json(message), kind) == message


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_text_is_decoded_without_its_byte_order_mark(encoding):
    assert codec.decode_text("tè caldo".encode(encoding)) == "tè caldo"


def test_a_text_in_another_encoding_is_not_decoded():
    with pytest.raises(UnicodeDecodeError):
        codec.decode_text("tè caldo".encode("latin-1"))


def test_the_wire_is_plain_messagepack():
    sent = Add(class_="Chair", at=(1, 2, 0.5))
    assert msgpack.unpackb(codec.encode(sent)) == {"verb": "add", "class": "Chair", "at": [1, 2, 0.5]}
    assert codec.decode(msgpack.packb({"class": "Chair", "at": [1, 2, 0.5]}), Add) == sent
    assert codec.encoding_of(sent) == "application/msgpack;semmap.Add.v1"


def test_no_garbage_is_collected_while_a_large_message_is_read():
    triples = tuple(("<a>", "<b>", f"<c{i}>") for i in range(20_000))
    large = codec.encode(Transaction(id="1", source="file", insert=triples))
    began = []
    gc.callbacks.append(lambda phase, info: began.append(phase))
    try:
        read = codec.decode(large, Transaction)
        count = len(began)
    finally:
        gc.callbacks.pop()
    assert (count, gc.isenabled(), len(read.insert)) == (0, True, 20_000)
    with pytest.raises(errors.BadRequest):
        codec.decode(large + b"!", Transaction)
    assert gc.isenabled()


def test_nothing_is_unpacked():
    bomb = zlib.compress(bytes(1 << 20))
    with pytest.raises(errors.BadRequest, match="malformed"):
        codec.decode(bomb, Departed)


@pytest.mark.parametrize("kind", [Any, dict[str, Any], Departed, Transaction, Snapshot])
@pytest.mark.parametrize("head", [b"\xdd", b"\xdf", b"\xc6", b"\xdb"], ids=["array", "map", "bytes", "text"])
def test_what_promises_more_than_comes_takes_no_memory_for_it(kind, head):
    with pytest.raises(errors.BadRequest):
        codec.decode(head + b"\xff\xff\xff\xff", kind)


NUMBER = "must be a number from -10000 to 10000"
SIZE = "must be a number above 0 and up to 10000"
TEXT = "must be a text of 1 to 1000 characters"
NAME = "must be a valid name: up to 128 letters, digits, '_', '.' and '-', beginning with a letter or '_'"


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"at": [math.nan, 0, 0]}, f"at: the 1st {NUMBER}"),
        ({"at": [0, math.inf, 0]}, f"at: the 2nd {NUMBER}"),
        ({"at": [0, 0, -1e300]}, f"at: the 3rd {NUMBER}"),
        ({"at": [0, 0, "up"]}, f"at: the 3rd {NUMBER}"),
        ({"at": [0, 0]}, "at must be 3 numbers"),
        ({"at": "here"}, "at must be 3 numbers"),
        ({"yaw": []}, "yaw must be a number or a text of up to 40 characters"),
        ({"size": [1, 1, 0]}, f"size: the 3rd {SIZE}"),
        ({"size": [-1, 1, 1]}, f"size: the 1st {SIZE}"),
        ({"size": [math.nan, 1, 1]}, f"size: the 1st {SIZE}"),
        ({"ref": ""}, f"ref {TEXT}"),
        ({"ref": "x" * 1001}, f"ref {TEXT}"),
        ({"alt": ["ok"] * 11 + [""]}, f"alt: the 12th {TEXT}"),
        ({"alt": "seat"}, "alt must be a list"),
        ({"name": "a b"}, f"name {NAME}"),
        ({"name": "1chair"}, f"name {NAME}"),
        ({"name": "chair1\n"}, f"name {NAME}"),
        ({"name": "chair/1"}, f"name {NAME}"),
        ({"name": "x" * 129}, f"name {NAME}"),
        ({"name": ""}, f"name {NAME}"),
        ({"source": "god"}, "source must be one of agent, file, operator, perception, scene"),
        ({"confidence": 1.5}, "confidence must be a number from 0 to 1"),
        ({"wait": 3}, "wait must be true or false"),
        ({"class": 3}, "class must be a text of 1 to 200 characters"),
        ({"verb": "remove"}, "verb must be add"),
        ({"siez": [1, 1, 1]}, "there is no field 'siez'; did you mean size or since?"),
    ],
)
def test_a_bad_field_is_named_with_what_it_may_be(fields, text):
    with pytest.raises(errors.BadRequest) as caught:
        codec.decode(msgpack.packb({"class": "Chair", **fields}), Add)
    assert caught.value.text == f"malformed message: {text}"


@pytest.mark.parametrize(
    ("payload", "text"),
    [
        (b"", "it ends too early"),
        (codec.encode(Add(class_="Chair"))[:-1], "it ends too early"),
        (b'{"class": ', "it ends too early"),
        (b"\x80", "class is missing"),
        (b"\x91\x01", "it must be an object with named fields"),
        (b"\x81\xa5class\xa2\xff\xfe", "it contains text that is not UTF-8"),
        (b"\xc1", "it is not valid MessagePack or JSON: invalid opcode '\\xc1' (byte 0)"),
        (b'{"class": nonsense}', "it is not valid MessagePack or JSON: invalid character (byte 14)"),
        (b'{"class": "Chair", "at": [1e999, 0, 0]}', f"at: the 1st {NUMBER}"),
    ],
)
def test_invalid_messages_are_reported(payload, text):
    with pytest.raises(errors.BadRequest) as caught:
        codec.decode(payload, Add)
    assert caught.value.text == f"malformed message: {text}"


@pytest.mark.parametrize("payload", [b"\x91" * 100_000, b'{"a":' * 100_000])
def test_a_deeply_nested_message_is_refused(payload):
    with pytest.raises(errors.BadRequest, match="nested too deeply"):
        codec.decode(payload, Any)


@given(st.binary(max_size=60), st.sampled_from(messages.TYPES))
def test_any_bytes_are_a_message_or_a_bad_request(payload, kind):
    with contextlib.suppress(errors.BadRequest):
        codec.decode(payload, kind)


def test_a_value_in_a_list_is_reported_by_its_position():
    with pytest.raises(errors.BadRequest, match="the 2nd: there is no field 'nmae'; did you mean name"):
        codec.decode(msgpack.packb([{"name": "a", "types": []}, {"nmae": "b"}]), tuple[Departed, ...])
    with pytest.raises(errors.BadRequest, match=r"the quaternion .* has length 0; it must be 1"):
        codec.decode(msgpack.packb({"position_m": [0, 0, 0], "orientation_wxyz": [0, 0, 0, 0]}), Pose)


def test_text_that_is_not_utf8_cannot_be_sent():
    with pytest.raises(errors.BadRequest, match="not UTF-8"):
        codec.encode(Add(class_="\udcff"))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"class": "Chair", "at": "1,2.5,-3e-1"}, Add(class_="Chair", at=(1.0, 2.5, -0.3))),
        ({"class": "Chair", "alt": "a|b, c", "wait": ""}, Add(class_="Chair", alt=("a", "b, c"), wait=True)),
        ({"class": "Chair", "wait": "true", "ref": "1"}, Add(class_="Chair", wait=True, ref="1")),
        ({"names": "chair1|table1"}, Remove(names=("chair1", "table1"))),
        ({"class": "1", "format": "lu4r"}, List(class_="1", format="lu4r")),
        ({"content": "aGk="}, Load(content=b"hi")),
        ({}, Check()),
    ],
)  # fmt: skip
def test_selector_parameters_are_the_same_fields_as_text(parameters, message):
    assert codec.from_text(parameters, type(message)) == message


@pytest.mark.parametrize(
    ("parameters", "kind", "text"),
    [
        ({"class": "Chair", "at": "1,2"}, Add, "at must be 3 numbers"),
        ({"class": "Chair", "at": "1,2,x"}, Add, f"at: the 3rd {NUMBER}"),
        ({"class": "Chair", "at": "nan,0,0"}, Add, f"at: the 1st {NUMBER}"),
        ({"clas": "Chair"}, Add, "there is no field 'clas'; did you mean class?"),
        ({"seconds": "3600"}, StepOnce, "seconds must be a number above 0 and up to 60"),
        ({"engine": "jena"}, Check, "engine must be one of owlrl, semmap"),
        ({"content": "*"}, Load, "content must be bytes (base64 in text)"),
        (
            {"xyzzy": "1"},
            Remove,
            "there is no field 'xyzzy'; there are: names, unchanged, since, dry_run, id, source, agent,"
            " reason",
        ),
    ],
)
def test_a_bad_parameter_is_named(parameters, kind, text):
    with pytest.raises(errors.BadRequest) as caught:
        codec.from_text(parameters, kind)
    assert caught.value.text == f"malformed message: {text}"


def test_anything_can_be_shown_as_json():
    assert codec.as_json(codec.encode(Check())) == '{"verb":"check"}'
    assert codec.as_json(b'{ "a": 1 }') == '{"a":1}'
    assert codec.as_json(b"\xff\xd8\xff") == "3 bytes"


@pytest.mark.parametrize(
    ("kind", "fields", "text"),
    [
        (
            List,
            {"as_of": ""},
            "as_of must be a whole number from 0 or a number from 0 or a text of 1 to 100 characters",
        ),
        (Undo, {"commit": "0"}, "commit must be a whole number from 1 to 9007199254740992"),
    ],
)
def test_what_may_be_several_things_and_large_bounds_are_spelled_out(kind, fields, text):
    with pytest.raises(errors.BadRequest) as caught:
        codec.from_text(fields, kind)
    assert caught.value.text == f"malformed message: {text}"


def test_a_number_that_is_too_large_is_reported():
    with pytest.raises(errors.BadRequest, match="more than 64 bits"):
        codec.encode({"values": [10**40]})


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        (SnapshotQuery, {"limit": 2**64 - 1}),
        (Recall, {"seqs": [2**64 - 1]}),
        (TakeBack, {"id": "x", "source": "operator", "commit": 2**64 - 1}),
    ],
)
def test_numbers_that_no_index_has_are_refused(kind, fields):
    with pytest.raises(errors.BadRequest, match="must be a whole number from"):
        codec.decode(msgpack.packb(fields), kind)


@pytest.mark.parametrize(
    "command",
    [
        {"verb": "get", "name": "x" * 1001},
        {"verb": "remove", "names": ["x" * 1001]},
        {"verb": "explain", "name": "x", "predicate": "x" * 1001, "value": "y"},
        {"verb": "check", "id": "x" * 201},
        {"verb": "check", "agent": "x" * 201},
        {"verb": "check", "reason": "x" * 1001},
    ],
)
def test_texts_have_an_end_before_anybody_looks_at_them(command):
    with pytest.raises(errors.BadRequest, match="must be a text of up to") as refused:
        codec.decode(msgpack.packb(command), COMMANDS[command["verb"]])
    assert len(refused.value.text) < 300


MEET_AT_ONCE = """
import sys, threading
from msgspec import defstruct, json, msgpack
from semmap.schemas import codec

sys.setswitchinterval(1e-6)  # threads take turns as often as they can
content = {f"field{i}": {"x": 1} for i in range(10)}
packed, text = msgpack.encode(content), json.encode(content)
for number in range(60):
    inner = [defstruct(f"Inner{i}", [("x", int | None, None), ("y", str, "")]) for i in range(10)]
    kind = defstruct("Outer", [(f"field{i}", one | None, None) for i, one in enumerate(inner)])
    start = threading.Barrier(3)

    def read(how):
        start.wait(10)
        assert how(kind).field9.x == 1

    hows = (
        lambda kind: codec.decode(packed, kind),
        lambda kind: codec.decode(text, kind),
        lambda kind: codec.convert(content, kind),
    )
    threads = [threading.Thread(target=read, args=(how,)) for how in hows]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
print("alive")
"""


def test_threads_may_meet_a_type_for_the_first_time_at_once():
    """msgspec alone ends such a process with a segmentation fault."""
    done = subprocess.run([sys.executable, "-c", MEET_AT_ONCE], capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stdout, done.stderr) == (0, "alive\n", "")
