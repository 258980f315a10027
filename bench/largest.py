#!/usr/bin/python3 -Es
"""The largest experiments that `orchestrator check` answers within a time: the table of docs/scaling.md.

  bench/largest.py [--seconds S] [--program PATH] [LIST...]

Each list grows until the answer takes longer, or until it is refused because of its own limit. It is the time of the
processor that counts: other work on the machine changes little.
"""

import argparse
import math
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RING = "run.duration_s = 100000\ngraph.topology = 'ring'\nlaw.name = 'consensus'\n"
TEAM = RING + "agents.count = 4\n"


def listed(count, item):
    return "[" + ", ".join(item(k) for k in range(count)) + "]\n"


def tables(name, count, keys):
    return "".join(f"[[{name}]]\n{keys(k)}\n" for k in range(count))


def agents(count, more=""):
    return f"agents.count = {count}\nagents.model = 'double_integrator'\n" + more


def path(count):
    return listed(count - 1, lambda k: f"[{k + 2}, {k + 1}]")


def positions(count):
    return "agents.position_m = " + listed(count, lambda k: f"[{2 * k}, 0, 1]")


LISTS = {
    "agents on a ring": lambda n: RING + agents(n, positions(n)),
    "agents on a complete graph": lambda n: "run.duration_s = 9\nlaw.name = 'consensus'\n" + agents(n, positions(n)),
    "`[[agents.override]]`": lambda n: RING + agents(n, positions(n))
    + tables("agents.override", n, lambda k: f"id = {k + 1}\nstart_s = 1"),
    "`[[agents.override]]` with a law": lambda n: RING + agents(n, positions(n))
    + tables("agents.override", n, lambda k: f"id = {k + 1}\nlaw.p_gain = 0.2"),
    "`[[events]]` that set a key": lambda n: TEAM
    + tables("events", n, lambda k: f"at_s = {k}\nset = {{ law.p_gain = 0.{k % 9 + 1} }}"),
    "`[[events]]` that set keys of single agents": lambda n: TEAM
    + tables("events", n, lambda k: f"at_s = {k}\nset = {{ law.p_gain = 0.2 }}\nagents = [{k % 4 + 1}]"),
    "`[[events]]` that cut and mend": lambda n: TEAM
    + tables("events", n, lambda k: f"at_s = {k}\n{'cut' if k % 2 == 0 else 'mend'} = [[1, 2]]"),
    "`[[law.schedule]]`": lambda n: RING.replace("100000", "1000000") + "agents.count = 4\ncontrol.rate_hz = 1\n"
    + tables("law.schedule", n, lambda k: f"at_s = {k + 1}\np_gain = 0.{k % 9 + 1}"),
    "`[[graph.schedule]]`": lambda n: TEAM
    + tables("graph.schedule", n, lambda k: f"at_s = {k + 1}\nedges = [[1, 2], [2, 1]]"),
    "waypoints": lambda n: "run.duration_s = 9\nagents.count = 1\nlaw = { name = 'waypoint', axes = 'xyz', waypoints_m = "
    + listed(n, lambda k: f"[{k % 900}, 0, 1]").strip() + " }\n",
    "`[[physics.obstacles]]`": lambda n: TEAM + tables(
        "physics.obstacles", n, lambda k: f"shape = 'box'\nposition_m = [{-2000 - 2 * k}, 0, 1]\nsize_m = [1, 1, 1]"),
    "`[[link.override]]`": lambda n: RING + agents(10000, positions(10000)) + tables(
        "link.override", n, lambda k: f"edges = [[{k % 9999 + 2 - k // 9999}, {k % 9999 + 1 + k // 9999}]]\nloss = 0.1"),
    "`[[hosts]]`": lambda n: RING + agents(1000, positions(1000))
    + tables("hosts", n, lambda k: f"name = 'h{k}'\nagents = '{k + 1}'"),
}


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def answer(program, toml, seconds):
    """How long `check` takes (s); infinite: longer than `seconds`, or it refuses the file."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(toml)
        file.flush()
        begun = processor_s()
        most = math.ceil(seconds) + 1
        done = subprocess.run([program, "check", file.name], capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most)))
        took = processor_s() - begun
    if took > seconds:
        return float("inf"), "slower"
    return (took, "") if done.returncode == 0 else (float("inf"), done.stderr.strip().splitlines()[0].split(": ", 2)[2])


def largest(program, toml_of, seconds):
    """The largest length that is answered in time, of 1, 2, 5, 10, ...; how long it takes; why no larger one is."""
    best, took = 0, 0.0
    for power in range(7):
        for digit in (1, 2, 5):
            length = digit * 10**power
            time_s, why = answer(program, toml_of(length), seconds)
            if time_s == float("inf") and length > 2:
                return best, took, why
            if time_s != float("inf"):
                best, took = length, time_s
    return best, took, ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lists", metavar="LIST", nargs="*", help="parts of their names (all)")
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--program", default=str(ROOT / "build/release/orchestrator"))
    options = parser.parse_args()
    print("| list | largest | takes | the next is |\n|---|---|---|---|")
    for name, toml_of in LISTS.items():
        if options.lists and not any(part in name for part in options.lists):
            continue
        length, took, why = largest(options.program, toml_of, options.seconds)
        print(f"| {name} | {length} | {took:.2f} s | {why} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
