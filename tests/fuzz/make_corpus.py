#!/usr/bin/python3
"""Makes tests/fuzz/corpus/ again: small inputs from which the fuzzers start. Recordings are written by hand, without
compression and checksums, so that a changed byte reaches what is behind them; one is of a real run.

  tests/fuzz/make_corpus.py [FOLDER OF orchestrator]"""

import io
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORPUS = ROOT / "tests/fuzz/corpus"
MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = range(1, 7)
ATTACHMENT, STATISTICS, METADATA, DATA_END = 9, 11, 12, 15
CDR = b"\x00\x01\x00\x00"  # encapsulation: little endian

CONFIG = b"""format = 1
[run]
name = "seed"
duration_s = 0.02
mode = "lockstep"
[agents]
count = 1
[control]
rate_hz = 100
[record]
topics = ["/agent_*", "/clock"]
"""


# --- samples ----------------------------------------------------------------------------------------------


def head(tick, agent=1):
    return struct.pack("<iIQI", 0, tick * 10_000_000, tick, agent)


def state(tick, agent=1):
    return head(tick, agent) + bytes(4) + struct.pack("<16d", 1, 2, 3, 0, 0, 0, 1, *[0.5] * 9)


def command(tick):
    return head(tick) + struct.pack("<I10d", 1, *[0.25] * 10)


def message(tick):
    return head(tick) + struct.pack("<I2d", 2, 1.5, 2.5)


def clock(tick):
    return struct.pack("<iI", 0, tick * 10_000_000)


def text(value):
    data = value.encode() + b"\0"
    return struct.pack("<I", len(data)) + data + bytes(-len(data) % 4)


def status():
    return text("agents_1-3") + struct.pack("<IB7xQQ6dQQQ", 1, 2, 5, 0, *[0.0] * 6, 0, 0, 0) + text("why")


def samples():
    """By the first byte, the type in the order of tests/fuzz/samples.cc."""
    bundle = struct.pack("<QII", 0, 2, 3) + b"".join(state(0, agent) for agent in (1, 2, 3)) + bytes(8)
    request = b"\x01\0\0\0" + text("stop")
    process = text("agent_1") + struct.pack("<QQ", 1, 0)
    experiment = struct.pack("<I", 1) + process + text("seed") + text(CONFIG.decode())
    bodies = [state(3), command(3), message(3), clock(3), status(), bundle, request, experiment]
    return {f"{kind}_{k}": bytes([k]) + CDR + body
            for k, (kind, body) in enumerate(zip("state command message clock status bundle request experiment".split(), bodies))}


# --- recordings -------------------------------------------------------------------------------------------


def string(data):
    data = data if isinstance(data, bytes) else data.encode()
    return struct.pack("<I", len(data)) + data


def record(op, body):
    return struct.pack("<BQ", op, len(body)) + body


def announcements():
    schema = struct.pack("<H", 1) + string("test_msgs/msg/Any") + string("ros2msg") + string("uint64 n\n")
    channels = b"".join(
        record(CHANNEL, struct.pack("<HH", k, 1) + string(topic) + string("cdr") + string(b""))
        for k, topic in enumerate(["/agent_1/command", "/agent_1/state", "/clock"], 1))
    return record(SCHEMA, schema) + channels


def messages():
    return b"".join(
        record(MESSAGE, struct.pack("<HIQQ", channel, tick, tick * 10_000_000, tick * 10_000_000) + CDR + body)
        for tick in range(3)
        for channel, body in enumerate([command(tick), state(tick), clock(tick)], 1))


def recording(chunked):
    config = struct.pack("<QQ", 0, 0) + string("config.toml") + string("application/toml")
    config += struct.pack("<Q", len(CONFIG)) + CONFIG + bytes(4)
    about = string("mascot") + string(string("format") + string("1"))
    out = MAGIC + record(HEADER, string("ros2") + string("seed"))
    out += record(ATTACHMENT, config) + record(METADATA, about)
    inner = announcements() + messages()
    if chunked:
        head_of_chunk = struct.pack("<QQQI", 0, 20_000_000, len(inner), 0) + string(b"") + struct.pack("<Q", len(inner))
        inner = record(CHUNK, head_of_chunk + inner)
    out += inner + record(DATA_END, bytes(4))
    counts = b"".join(struct.pack("<HQ", channel, 3) for channel in (1, 2, 3))
    statistics = struct.pack("<QHIIIIQQ", 9, 1, 3, 1, 1, chunked, 0, 20_000_000) + string(counts)
    # A summary must index every chunk; this one has only the statistics, so a chunked file is damaged at its end.
    return out + record(STATISTICS, statistics) + record(FOOTER, struct.pack("<QQI", len(out), 0, 0)) + MAGIC


def real_recording(programs):
    """Samples of one agent, for three ticks."""
    with tempfile.TemporaryDirectory() as folder:
        config = pathlib.Path(folder) / "seed.toml"
        config.write_text("[run]\nduration_s = 0.02\n[agents]\ncount = 1\nmodel = 'double_integrator'\n[graph]\n"
                          "edges = []\n[law]\nname = 'waypoint'\nwaypoints_m = [[1, 1, 1]]\n")
        subprocess.run([programs / "orchestrator", "up", config, "--engine", "inprocess", "--out", f"{folder}/run",
                        "--quiet", "--set", "output.save_plot=false"], timeout=60, check=True)
        return (pathlib.Path(folder) / "run/run.mcap").read_bytes()


def recordings(programs):
    whole = recording(chunked=False)
    return {"loose": whole, "chunked": recording(chunked=True), "cut": whole[:len(whole) // 2],
            "real": real_recording(programs)}


# --- events of protocols ----------------------------------------------------------------------------------


def protocols():
    """By the first byte, the object in the order of tests/fuzz/protocols.cc; then any events."""
    return {f"events_{k}": bytes([k]) + random.Random(k).randbytes(256) for k in range(7)}


# --- messages of viewers ------------------------------------------------------------------------------------


def viewers():
    """Lists of messages, as tests/fuzz/viewers.cc reads them."""
    def texts(*messages):
        return b"".join(struct.pack("<BI", 0, len(one)) + one for one in messages)

    def binaries(*messages):
        return b"".join(struct.pack("<BI", 1, len(one)) + one for one in messages)

    def repeated(is_text, begin, part, times, end=b"", may_be_longest=False):
        kind = (254 if may_be_longest else 2) + (not is_text)
        return (struct.pack("<BH", kind, len(begin)) + begin + struct.pack("<B", len(part)) + part
                + struct.pack("<IH", times, len(end)) + end)

    goal = b'{"op":"advertise","channels":[{"id":%d,"topic":"/goal","encoding":"%s","schemaName":"geometry_msgs/PoseStamped"}]}'
    pose = CDR + struct.pack("<iI", 0, 0) + text("agent_3") + bytes(4) + struct.pack("<7d", 1, 2, 3, 0, 0, 0, 1)
    pose_json = b'{"header":{"frame_id":"agent_3"},"pose":{"position":{"x":1,"y":2,"z":3}}}'
    ask = b'{"ask":"event","toml":"goto = {}"}'
    return {
        "subscribe": texts(b'{"op":"subscribe","subscriptions":[{"id":0,"channelId":0},{"id":1,"channelId":1}]}',
                           b'{"op":"unsubscribe","subscriptionIds":[0]}'),
        "parameters": texts(b'{"op":"getParameters","parameterNames":[],"id":"all"}',
                            b'{"op":"subscribeParameterUpdates","parameterNames":["law.p_gain"]}',
                            b'{"op":"setParameters","parameters":[{"name":"law.p_gain","value":[1,true,"x"]}],"id":"set"}',
                            b'{"op":"unsubscribeParameterUpdates","parameterNames":[]}'),
        "connections": texts(b'{"op":"subscribeConnectionGraph"}', b'{"op":"unsubscribeConnectionGraph"}'),
        "goal_cdr": texts(goal % (1, b"cdr")) + binaries(b"\1" + struct.pack("<I", 1) + pose),
        "goal_json": texts(goal % (2, b"json")) + binaries(b"\1" + struct.pack("<I", 2) + pose_json)
                     + texts(b'{"op":"unadvertise","channelIds":[2]}'),
        "ask": binaries(b"\2" + struct.pack("<III", 0, 5, 4) + b"json" + ask),
        "deep_text": repeated(True, b"", b"[", 1_000_000) + repeated(True, b"", b'{"op":', 100_000, b'"x"'),
        "deepest_text": repeated(True, b"", b"[", 1_000_000, may_be_longest=True),
        "deep_value": repeated(True, b'{"op":"setParameters","parameters":[{"name":"x","value":', b"[", 900_000, b"]}]}"),
        "deep_list": repeated(True, b'{"op":"subscribe","subscriptions":', b'[{"id":', 100_000),
        "deep_ask": repeated(False, b"\2" + struct.pack("<III", 0, 5, 4) + b'json{"ask":', b"[", 900_000),
        "deep_goal": texts(goal % (2, b"json")) + repeated(False, b"\1" + struct.pack("<I", 2) + b'{"pose":', b'{"pose":', 100_000),
        "playback": binaries(b"\3" + struct.pack("<BfBQI", 1, 2.0, 1, 1000, 2) + b"r1"),
    }


# --- what clients of `orchestrator serve` say ---------------------------------------------------------------


def served():
    """Lists of messages, as tests/fuzz/serve.cc reads them."""
    def lines(*messages):
        return b"".join(struct.pack("<BH", 0, len(one)) + one for one in messages)

    def step(ticks, *actions):
        content = struct.pack(f"<I{len(actions)}d", ticks, *actions)
        return struct.pack("<BH", 1, len(content)) + content

    hello = b'{"request":"hello","protocol":1}'
    return {
        "steps": lines(hello, b'{"request":"step","actions":[1,0,0],"ticks":3,"id":7}', b'{"request":"look"}',
                       b'{"request":"step","actions":{"1":[0,1,0]}}', b'{"request":"step","ticks":100}', b'{"request":"close"}'),
        "resets": lines(hello, b'{"request":"reset","seed":3,"ports":[1,2],"set":{"law.p_gain":0.5,"law.axes":"xyz"}}',
                        b'{"request":"step","actions":[[1,0,0],null]}', b'{"request":"reset","ports":[]}'),
        "events": lines(hello, b'{"request":"set","set":{"law.p_gain":0.1},"agents":[1]}', b'{"request":"step"}',
                        b'{"request":"goto","agent":2,"position_m":[1,2,3]}',
                        b'{"request":"event","event":{"fault":{"agent":2,"kind":"kill"}}}', b'{"request":"step","ticks":2}'),
        "snapshots": lines(hello, b'{"request":"step","ticks":4}', b'{"request":"snapshot"}', b'{"request":"step"}',
                           b'{"request":"restore","snapshot":1}', b'{"request":"forget","snapshot":1}',
                           b'{"request":"snapshot","form":"text"}', b'{"request":"restore","text":"{}"}'),
        "binary": lines(b'{"request":"hello","protocol":1,"form":"binary"}', b'{"request":"look"}') + step(3, 1, 0, 0) + step(1),
        "stranger": lines(b"GET / HTTP/1.1\r"),
    }


# --- networks -----------------------------------------------------------------------------------------------


def networks():
    """Networks of the format ONNX, a few operators in each."""
    def varint(number):
        out = bytearray()
        number &= (1 << 64) - 1
        while number >= 0x80:
            out.append(number & 0x7f | 0x80)
            number >>= 7
        return bytes(out + bytes([number]))

    def field(number, value):
        if isinstance(value, int):
            return varint(number << 3) + varint(value)
        value = value.encode() if isinstance(value, str) else value
        return varint(number << 3 | 2) + varint(len(value)) + value

    def port(name, *shape):
        dims = b"".join(field(1, field(1, length)) for length in shape)
        return field(1, name) + field(2, field(1, field(1, 1) + field(2, dims)))

    def tensor(name, shape, numbers):
        is_float = isinstance(numbers[0], float)
        data = struct.pack(f"<{len(numbers)}{'f' if is_float else 'q'}", *numbers)
        return b"".join(field(1, n) for n in shape) + field(2, 1 if is_float else 7) + field(8, name) + field(9, data)

    def attribute(name, value):
        kind = field(3, value) + field(20, 2) if isinstance(value, int) else (
            b"".join(field(8, one) for one in value) + field(20, 7))
        return field(5, field(1, name) + kind)

    def node(op, inputs, output, **attributes):
        return (b"".join(field(1, name) for name in inputs) + field(2, output) + field(4, op)
                + b"".join(attribute(name, value) for name, value in attributes.items()))

    def model(opset, inputs, nodes, constants=()):
        parts = [field(1, one) for one in nodes] + [field(5, tensor(*one)) for one in constants]
        graph = b"".join(parts) + field(11, port("x", 1, inputs)) + field(12, port("y", 1, inputs))
        return field(1, 7) + field(7, graph) + field(8, field(2, opset)) + field(14, field(1, "k") + field(2, "v"))

    def chain(*ops):
        return [node(op, ["x" if k == 0 else f"t{k - 1}"], "y" if k == len(ops) - 1 else f"t{k}")
                for k, op in enumerate(ops)]

    return {
        "numbers": model(13, 4, chain("Relu", "Tanh", "Sigmoid", "Softplus", "Elu", "LeakyRelu", "Abs", "Neg", "Exp",
                                      "Sqrt", "Identity", "Clip", "Softmax")),
        "products": model(13, 2, [node("Gemm", ["x", "w", "b"], "g", transB=1), node("MatMul", ["g", "w"], "m"),
                                  node("Add", ["m", "b"], "a"), node("Sub", ["a", "x"], "s"),
                                  node("Div", ["s", "b"], "d"), node("Mul", ["d", "x"], "y")],
                          [("w", [2, 2], [1.0, 2.0, 3.0, 4.0]), ("b", [2], [1.0, 0.5])]),
        "moves": model(13, 4, [node("Reshape", ["x", "2x2"], "r"), node("Transpose", ["r"], "t", perm=[1, 0]),
                               node("Unsqueeze", ["t", "0"], "u"), node("Squeeze", ["u", "0"], "q"),
                               node("Concat", ["q", "t"], "c", axis=1), node("Slice", ["c", "0", "2", "1", "1"], "s"),
                               node("Flatten", ["s"], "y", axis=0)],
                       [("2x2", [2], [2, 2]), ("0", [1], [0]), ("1", [1], [1]), ("2", [1], [2])]),
        "reductions": model(18, 4, [node("ReduceSum", ["x", "1"], "s", keepdims=1), node("ReduceMax", ["x"], "m"),
                                    node("ReduceMean", ["x", "1"], "a"), node("Concat", ["s", "m", "a"], "y", axis=1)],
                            [("1", [1], [1])]),
        "older": model(9, 4, [node("Slice", ["x"], "s", axes=[1], starts=[0], ends=[2]),
                              node("ReduceMean", ["s"], "r", axes=[1]), node("Unsqueeze", ["r"], "u", axes=[0]),
                              node("Squeeze", ["u"], "y", axes=[0])]),
        "consensus": (ROOT / "configs/policy.onnx").read_bytes(),
    }


# --- FMUs ---------------------------------------------------------------------------------------------------


def fmus():
    """Descriptions of FMUs, those of the FMUs of tests, and small archives."""
    sys.path.append(str(ROOT / "tests/fmus"))
    import pack

    files = {}
    for version, platform in [(2, "linux64"), (3, "x86_64-linux")]:
        files[f"description_{version}"] = pack.description(version).encode()
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
            for name, text in [("modelDescription.xml", f'<fmiModelDescription fmiVersion="{version}.0"/>'),
                               (f"binaries/{platform}/law.so", "x" * 50), ("resources/a", "")]:
                entry = zipfile.ZipInfo(name)  # of 1980, so that the same files give the same bytes
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
                packed.writestr(entry, text)
        files[f"archive_{version}"] = archive.getvalue()
    return files


# --- what vehicles and scripts that fly Crazyflies send ------------------------------------------------------


def vehicles():
    """The first byte chooses among topics of the same message, and what a Crazyflie does meanwhile."""
    stamp = struct.pack("<iI", 5, 6) + text("map")
    pose = struct.pack("<7d", 1, 2, 3, 0, 0, 0, 1)
    duration = struct.pack("<iI", 2, 500_000_000)
    piece = b"".join(struct.pack("<I8f", 8, *range(8)) for _ in range(4)) + duration
    odometry = struct.pack("<QQB3x7fB3x15fBB", 1, 1, 1, 1, 2, 3, 1, 0, 0, 0, 1, *[0.5] * 15, 3, 100)
    bodies = {
        **{f"px4_of_{length}_bytes": bytes(range(length)) for length in (20, 23, 25, 71, 80, 82, 83)},
        "px4_odometry": odometry,
        "pose": stamp + pose,
        "twist": stamp + struct.pack("<6d", 1, 2, 3, 4, 5, 6),
        "poses": stamp + struct.pack("<I", 1) + text("cf1") + pose,
        "status": stamp + struct.pack("<BBBBBxxxI2B", 2, 1, 9, 1, 1, 2, 22, 24),
        "names": struct.pack("<I", 2) + text("robots.cf1.uri") + text("a"),
        "height": struct.pack("<B3xf", 0, 0.5) + duration,
        "go_to": struct.pack("<BB6x3df", 0, 1, 1, 2, 3, 0.1) + duration,
        "upload": struct.pack("<B3xII", 7, 0, 2) + piece + piece,
        "follow": struct.pack("<BB2xfBB", 0, 7, 1.5, 1, 0),
        "full_state": stamp + struct.pack("<16d", *range(16)),
        "hover": stamp + struct.pack("<4f", 1, 0, 0.1, 0.5),
    }
    return {name: bytes([choices]) + CDR + body for choices, (name, body) in enumerate(bodies.items())}


def main():
    programs = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release")
    for name, files in [("samples", samples()), ("recording", recordings(programs)), ("protocols", protocols()),
                        ("viewers", viewers()), ("serve", served()), ("network", networks()),
                        ("fmu", fmus()), ("vehicles", vehicles())]:
        (CORPUS / name).mkdir(parents=True, exist_ok=True)
        for file, data in files.items():
            (CORPUS / name / file).write_bytes(data)


if __name__ == "__main__":
    main()
