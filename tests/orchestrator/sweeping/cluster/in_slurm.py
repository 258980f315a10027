#!/usr/bin/python3
"""Runs a command in a Slurm of its own, which begins and ends with it: in_slurm.py [--nodes N] COMMAND...

The cluster is Debian's: munged, slurmctld, and slurmd on hosts node1, node2, ... with 64 processors each, as far as Slurm
knows. All of it, and the command, is in namespaces of its own (processes, network, mounts, names): nothing outside
reaches it, several at once do not meet, and when the command has ended, the kernel ends every process that is left. The
hosts are network namespaces on one bridge. Configuration, state and logs are in /etc/slurm, over which a tmpfs lies.
It needs root, and the packages of `scripts/setup --test`.
"""

import argparse
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time

PROGRAMS = ["munged", "mungekey", "slurmctld", "slurmd", "sbatch", "srun", "ip"]
NAMESPACES = ["unshare", "--mount", "--uts", "--ipc", "--net", "--pid", "--fork", "--kill-child", "--mount-proc"]
FOLDER = pathlib.Path("/etc/slurm")
MOST_NODES = 200
LIMIT_S = 120  # for the nodes to come up
CONFIGURATION = """\
ClusterName=mascot
SlurmctldHost=head
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# A job that was queued again waits until its first credential is no longer valid: two minutes, unless told otherwise.
AuthInfo=socket={folder}/munge.socket,cred_expire=10
CredType=cred/munge
StateSaveLocation={folder}/slurmctld
SlurmdSpoolDir={folder}/slurmd.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
# There may be no cgroups here. This signals all descendants of a job, too, whatever process group they are in.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
# Short ways: this is a test.
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
KillWait=5
MinJobAge=3600
ReturnToService=2
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
NodeName=node[1-{nodes}] CPUs=64 RealMemory=65536 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE OverSubscribe=YES State=UP
"""


def why_not():
    """Why there can be no Slurm here; None: there can."""
    if os.geteuid() != 0:
        return "it takes root to make network namespaces"
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    if missing := [program for program in PROGRAMS if not shutil.which(program)]:
        return f"there is no {', '.join(missing)}: scripts/setup --test installs Slurm"
    may = subprocess.run([*NAMESPACES, "ip", "link", "add", "bridge", "type", "bridge"], capture_output=True, text=True,
                         timeout=LIMIT_S)
    return f"namespaces may not be made here: {may.stderr.strip()}" if may.returncode else None


def outside(nodes, command):
    """Never returns: becomes the namespaces, with this script in them. Their first process is a shell, which buries the
    orphans of the others: Slurm waits until no process of a job is left, dead or alive."""
    again = [sys.executable, __file__, "--inside", "--nodes", str(nodes), *command]
    os.execvp(NAMESPACES[0], [*NAMESPACES, "bash", "-c", '"$@"; exit $?', "bash", *again])


class Cluster:
    def __init__(self, nodes):
        self.daemons = []  # (name, process)
        run("mount", "-t", "tmpfs", "-o", "mode=755", "tmpfs", FOLDER)
        run("mount", "-t", "tmpfs", "tmpfs", "/dev/shm")
        names = [f"node{k}" for k in range(1, nodes + 1)]
        self.make_network(["head", *names])
        (FOLDER / "slurm.conf").write_text(CONFIGURATION.format(folder=FOLDER, nodes=nodes))
        (FOLDER / "slurmctld").mkdir()
        self.start_munged()
        self.start("slurmctld", "slurmctld", "-D", "-c")
        for k, name in enumerate(names, 1):
            self.start_node(k, name)
        self.until("all nodes are idle", lambda: output_of("sinfo", "--noheader", "--format=%D %T") == f"{nodes} idle\n")

    @staticmethod
    def make_network(names):
        (FOLDER / "hosts").write_text(
            "127.0.0.1 localhost\n" + "".join(f"{address(k)} {name}\n" for k, name in enumerate(names)))
        run("mount", "--bind", FOLDER / "hosts", "/etc/hosts")
        socket.sethostname(names[0])
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "bridge", "type", "bridge")
        run("ip", "addr", "add", f"{address(0)}/24", "dev", "bridge")
        run("ip", "link", "set", "bridge", "up")

    def start_munged(self):
        door = f"--socket={FOLDER}/munge.socket"
        files = [f"--{what}-file={FOLDER}/munge.{what}" for what in ("key", "pid", "seed", "log")]
        run("mungekey", "--create", "--keyfile", FOLDER / "munge.key")
        self.start("munged", "munged", "--foreground", "--force", *files, door)
        self.until("munged answers", lambda: succeeds("munge", "--no-input", door))

    def start_node(self, k, name):
        """slurmd, on a host of its own: with its own network, a wire to the bridge, and its own shared memory."""
        script = "mount -t tmpfs tmpfs /dev/shm && echo apart && read -r wired && exec slurmd -D"
        node = self.start(name, "unshare", "--net", "--uts", "--ipc", "--mount", "bash", "-c", script)
        self.until(f"{name} is apart", lambda: (FOLDER / f"{name}.log").read_text())
        inside = ["nsenter", f"--target={node.pid}", "--net", "--uts"]
        run("ip", "link", "add", name, "type", "veth", "peer", "name", "eth0", "netns", node.pid)
        run("ip", "link", "set", name, "master", "bridge", "up")
        run(*inside, "hostname", name)
        run(*inside, "ip", "link", "set", "lo", "up")
        run(*inside, "ip", "addr", "add", f"{address(k)}/24", "dev", "eth0")
        run(*inside, "ip", "link", "set", "eth0", "up")
        run(*inside, "ip", "route", "add", "239.0.0.0/8", "dev", "eth0")  # multicast
        node.stdin.write("wired\n")
        node.stdin.close()

    def start(self, name, *words):
        with (FOLDER / f"{name}.log").open("w") as log:
            daemon = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=log, stderr=subprocess.STDOUT, text=True)
        self.daemons.append((name, daemon))
        return daemon

    def until(self, what, is_so):
        deadline = time.monotonic() + LIMIT_S
        while not is_so():
            dead = [f"{name} has ended with code {daemon.returncode}"
                    for name, daemon in self.daemons if daemon.poll() is not None]
            if dead or time.monotonic() > deadline:
                reason = "; ".join(dead) or f"not within {LIMIT_S} s"
                raise SystemExit(f"error: Slurm: expected that {what}, got: {reason}\n{ends_of_logs()}")
            time.sleep(0.05)


def ends_of_logs():
    return "".join(f"--- {log}\n" + "".join(log.read_text().splitlines(keepends=True)[-20:])
                   for log in sorted(FOLDER.glob("*.log")))


def address(k):
    return f"10.79.0.{k + 1}"


def run(*words):
    subprocess.run([str(word) for word in words], check=True, timeout=LIMIT_S)


def succeeds(*words):
    return subprocess.run(words, capture_output=True, timeout=LIMIT_S).returncode == 0


def output_of(*words):
    return subprocess.run(words, capture_output=True, text=True, timeout=LIMIT_S).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=1, metavar="N", help=f"1 (the default) to {MOST_NODES}")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("command", nargs=argparse.REMAINDER)
    args = parser.parse_args()
    if not args.command or not 1 <= args.nodes <= MOST_NODES:
        parser.error(f"expected a command, on 1 to {MOST_NODES} hosts")
    if args.inside:
        Cluster(args.nodes)
        # As long as it takes: what it does, only its caller knows.
        return subprocess.run(args.command, timeout=None).returncode
    if reason := why_not():
        raise SystemExit(f"error: no Slurm here: {reason}")
    outside(args.nodes, args.command)


if __name__ == "__main__":
    sys.exit(main())
