#!/usr/bin/python3
"""kill_runs.py [--kills N] [--seed S] [--span S] [--programs DIR] [--set KEY=VALUE]...: what do runs leave behind when they
are killed?

Kills (SIGKILL) one process of a run over DDS, at a random moment, N times, and counts what is left behind: processes,
files in /dev/shm, locks of domains, files with private keys. Not part of the tests: 200 kills take several minutes.
Needs root: it works in namespaces of its own, with processes and a /dev/shm of its own.

The process is the orchestrator, the physics server, an agent or the janitor, each as likely. A run is killed from its
first moment to its last, and sometimes just after it has ended.
"""

import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONFIG = ROOT / "configs/leaderless.toml"
SHARED_MEMORY = pathlib.Path("/dev/shm")
SOCKETS = pathlib.Path("/proc/net/unix")
RUN_LIMIT_S = 200.0  # of a run whose process was killed
DEADLINE_S = 30.0  # what still lives then is left behind


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--span", type=float, default=1.5, help="kill within so many seconds of the start")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--set", action="append", default=[], dest="sets", metavar="KEY=VALUE", help="of each run")
    return parser.parse_args()


def processes():
    """Names of all processes of runs, by pid."""
    found = {}
    for folder in pathlib.Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        name = pathlib.Path(words[0].decode()).name
        if name in ("orchestrator", "physics_server", "agent", "vehicle", "janitor"):
            found[int(folder.name)] = name
    return found


def locked_domains():
    """Names of the sockets by which runs reserve domains (DomainLock)."""
    words = (line.split() for line in SOCKETS.read_text().splitlines())
    return sorted({word[-1] for word in words if word[-1].startswith("@mascot-domain-")})


def key_files():
    """Names of the files with private keys (network.security) in the folder for temporary files."""
    found = []
    for folder, _, names in os.walk(tempfile.gettempdir()):  # passes over folders that have just gone
        for name in names:
            path = pathlib.Path(folder) / name
            try:
                if path.is_file() and b"PRIVATE KEY" in path.read_bytes():
                    found.append(name)
            except OSError:  # it has just gone
                continue
    return sorted(found)


def kill_one(dice, args):
    """Kills a process of a run. Returns its name."""
    folder = tempfile.mkdtemp(prefix="mascot-kill-")
    up = subprocess.Popen(
        [args.programs / "orchestrator", "up", CONFIG, "--out", folder + "/run", "--quiet", "--duration-s", "12"]
        + [word for key in ["output.save_plot=false", *args.sets] for word in ("--set", key)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    time.sleep(dice.uniform(0, args.span))
    alive = processes()
    names = sorted(set(alive.values()))
    name = dice.choice(names) if names else "nobody"
    victims = sorted(pid for pid in alive if alive[pid] == name)
    if victims:
        try:
            os.kill(dice.choice(victims), signal.SIGKILL)
        except ProcessLookupError:
            name = "nobody"
    up.wait(RUN_LIMIT_S)
    shutil.rmtree(folder, ignore_errors=True)
    return name


def left_now():
    left = {
        "processes": sorted(processes().values()),
        "files": sorted(path.name for path in SHARED_MEMORY.iterdir()),
        "locks": locked_domains(),
        "keys": key_files(),
    }
    return {what: names for what, names in left.items() if names}


def left_behind():
    """What is left when every process has had its time to end."""
    deadline = time.monotonic() + DEADLINE_S
    while left_now() and time.monotonic() < deadline:
        time.sleep(0.01)
    return left_now()


def clear():
    for pid in processes():
        os.kill(pid, signal.SIGKILL)
    for path in SHARED_MEMORY.iterdir():
        path.unlink()


def main():
    args = arguments()
    if os.environ.get("MASCOT_KILLS_ALONE") is None:
        os.environ["MASCOT_KILLS_ALONE"] = "yes"
        mounts = "mount -t tmpfs tmpfs /dev/shm && mount -t tmpfs tmpfs /tmp"
        here = ["sh", "-c", mounts + ' && exec "$@"', "sh", sys.executable, *sys.argv]
        os.execvp("unshare", ["unshare", "--mount", "--net", "--pid", "--fork", "--mount-proc", *here])
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True, timeout=DEADLINE_S)
    dice = random.Random(args.seed)
    killed, failures = {}, 0
    for number in range(1, args.kills + 1):
        name = kill_one(dice, args)
        killed[name] = killed.get(name, 0) + 1
        left = left_behind()
        if left:
            failures += 1
            print(f"kill {number} of {name} left {left}", flush=True)
            clear()
    print(f"{failures} of {args.kills} kills left something behind; killed: {killed}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
