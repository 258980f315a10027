#!/usr/bin/python3
"""Sweeps as job arrays, in a real Slurm (in_slurm.py): what all tasks together fly is the table that one machine
makes, also if tasks are told that their time is up, are cancelled, or are queued again by others.

Ends with code 77 where there can be no Slurm, which ctest counts as skipped."""

import csv
import itertools
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import in_slurm

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path.insert(0, str(ROOT / "tests"))
import tour_test

CLUSTER = ROOT / "tests/orchestrator/sweeping/cluster/in_slurm.py"
INSIDE = "--inside"
SKIPPED = 77
END = "--- end of the command"
LIMIT_S = 120  # for Slurm to do what was asked
TOTAL_LIMIT_S = 280  # ctest ends the test after 300 s, without a word
WALL_COLUMNS = ["wall_s", "real_time_factor"]
NAME = "it's a \"100%j\" #1"  # of folders and files: all that a shell, sbatch and Slurm's file names take for their own
SWEEP = ["--set", "law.p_gain=0.05,0.1", "--set", "run.duration_s=0.5", "--seeds", "1..6"]

# A metric that holds task N, once two of its runs are in its table, as long as there is a file hold-N.
METRIC = """\
import os, pathlib, time

def _is_held():
    task, folder = os.environ.get("SLURM_ARRAY_TASK_ID"), pathlib.Path(__file__).parent
    tables = folder.glob(f"*/*.{task}-of-3.csv")
    return (folder / f"hold-{task}").exists() and any(len(table.read_text().splitlines()) > 2 for table in tables)

def last_x(run):
    while _is_held():
        time.sleep(0.01)
    return run["position"][-1, 0, 0]
"""

# Flies a run on the nodes of its job, kills what the orchestrator has started on node2, and ends the run when the four
# agents there are lost. The arguments are those of `orchestrator up`.
WITHOUT_NODE2 = """\
import os, pathlib, signal, subprocess, sys, time

def until(is_so):
    deadline = time.monotonic() + 100
    while not is_so():
        if up.poll() is not None or time.monotonic() > deadline:
            sys.exit("the run has ended, or did not do what was expected")
        time.sleep(0.01)

def said():
    return pathlib.Path("up.err").read_text()

def is_host_of_node2(process):
    try:
        return (b"\\0host\\0" in (process / "cmdline").read_bytes()
                and b"SLURMD_NODENAME=node2\\0" in (process / "environ").read_bytes())
    except OSError:
        return False

up = subprocess.Popen(sys.argv[1:], stderr=open("up.err", "w"))
until(lambda: "x real time" in said())
for process in filter(is_host_of_node2, pathlib.Path("/proc").glob("[0-9]*")):
    os.kill(int(process.name), signal.SIGKILL)
until(lambda: said().count("lost: agent_") == 4)
up.send_signal(signal.SIGINT)
sys.exit(up.wait(timeout=100))
"""


def ran(*words, code=0, **options):
    """What a command has printed."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=LIMIT_S, **options)
    if done.returncode != code:
        raise AssertionError(f"{words}: expected code {code}, got {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def rows(table):
    """The rows of a table, without what depends on the machine."""
    with open(table, newline="") as file:
        all_rows = list(csv.reader(file))
    if all_rows[0][-2:] != WALL_COLUMNS:
        raise AssertionError(f"{table}: expected {WALL_COLUMNS} as last columns, got {all_rows[0][-2:]}")
    return [row[:-2] for row in all_rows]


class Cluster(unittest.TestCase):
    def test_has_hosts_apart_that_reach_each_other(self):
        """Each opens a port, and calls the next one's by its name; none sees what another has in /dev/shm."""
        call = """
import os, socket, sys
host = int(os.environ["SLURM_PROCID"]) + 1
open(f"/dev/shm/{host}", "x").close()
with socket.create_server(("", 7000)) as door:
    print("open", flush=True)
    sys.stdin.readline()  # all are
    socket.create_connection((f"node{host % 3 + 1}", 7000)).close()
    door.accept()
print(socket.gethostname(), *os.listdir("/dev/shm"))
"""
        srun = subprocess.Popen([CLUSTER, "--nodes", "3", "srun", "--nodes=3", sys.executable, "-c", call], text=True,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        late = threading.Timer(LIMIT_S, srun.kill)  # what is read then ends, and is not what is expected
        late.start()
        self.addCleanup(late.cancel)
        self.assertEqual([srun.stdout.readline() for _ in range(3)], ["open\n"] * 3)
        said, _ = srun.communicate("all\n", timeout=LIMIT_S)
        self.assertEqual(sorted(said.splitlines()), ["node1 1", "node2 2", "node3 3"])
        self.assertEqual(srun.returncode, 0)

    def test_ends_with_the_code_of_its_command(self):
        ran(CLUSTER, "srun", "bash", "-c", "exit 7", code=7)
        ran(CLUSTER, code=2)
        ran(CLUSTER, "--nodes", 0, "true", code=2)

    def test_says_which_program_did_not_live(self):
        with tempfile.TemporaryDirectory(prefix="mascot-slurm-") as folder:
            broken = pathlib.Path(folder) / "slurmctld"
            broken.write_text("#!/bin/sh\necho no luck; exit 3\n")
            broken.chmod(0o755)
            done = subprocess.run([CLUSTER, "true"], env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"},
                                  capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "error: Slurm: expected that .*, got: slurmctld has ended with code 3\n(.*\n)*no luck\n")


class JobArrays(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        home = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(dir=in_slurm.FOLDER)))
        self.folder = home / NAME
        self.results = self.folder / "results of today"
        self.results.mkdir(parents=True)
        self.experiment = self.folder / "my experiment.toml"
        self.experiment.write_text((ROOT / "configs/leaderless.toml").read_text())
        self.metric = self.folder / "metric.py"
        self.metric.write_text(METRIC)
        self.table = self.results / f"{NAME}.csv"
        self.addCleanup(subprocess.run, ["scancel", "--user=root"], timeout=LIMIT_S)

    def orchestrator(self, *words, **options):
        return ran(f'{os.environ["MASCOT_BINARY_DIR"]}/orchestrator', *words, cwd=self.folder, **options)

    def sweep(self, *words):
        return self.orchestrator("sweep", self.experiment.name, *SWEEP, "--metric", self.metric.name, "--no-plot", *words)

    def submit(self, *words):
        """The number of the job array of this sweep: three tasks."""
        said = self.sweep("--out", self.table.relative_to(self.folder), "--slurm", "--tasks", 3, "--submit", *words)
        return re.search(r"Submitted batch job (\d+)\n", said)[1]

    def share(self, task):
        return self.table.with_name(f"{NAME}.{task}-of-3.csv")

    def log(self, task):
        path = self.table.with_name(f"{NAME}.{task}.log")
        return path.read_text() if path.exists() else ""

    def tasks(self, job):
        """What Slurm knows of the tasks of a job array, by number."""
        told = (dict(word.partition("=")[::2] for word in line.split() if "=" in word)
                for line in ran("scontrol", "--oneliner", "show", "job", job).splitlines())
        return {task["ArrayTaskId"]: task for task in told}

    def until(self, what, is_so):
        deadline = time.monotonic() + LIMIT_S
        while not is_so():
            if time.monotonic() > deadline:
                self.fail(f"expected that {what}, got for {LIMIT_S} s:\n{self.all_logs()}{ran('scontrol', 'show', 'job')}")
            time.sleep(0.02)

    def all_logs(self):
        return "".join(f"--- {log}\n{log.read_text()}" for log in sorted(self.folder.rglob("*.log")))

    def until_ended(self, job, **others):
        """Waits for all three tasks, which are COMPLETED but for others: task_2="CANCELLED"."""
        running = {"PENDING", "RUNNING", "COMPLETING", "REQUEUED"}
        self.until(f"all tasks of job {job} have ended",
                   lambda: not running & {task["JobState"] for task in self.tasks(job).values()})
        states = [task["JobState"] for _, task in sorted(self.tasks(job).items())]
        self.assertEqual(states, [others.get(f"task_{k}", "COMPLETED") for k in (1, 2, 3)], self.all_logs())

    def hold(self, task):
        (self.folder / f"hold-{task}").touch()

    def until_held(self, task):
        table = self.share(task)
        self.until(f"task {task} holds after two runs", lambda: table.exists() and len(table.read_text().splitlines()) == 3)

    def let_go(self, task):
        (self.folder / f"hold-{task}").unlink()

    def merge(self):
        return self.orchestrator("sweep", "merge", *sorted(self.results.glob("*-of-3.csv")), "--out", self.table, "--no-plot")

    def check_merged(self):
        """Merges, and compares with the same sweep on this machine."""
        self.assertIn("12 runs of 3 tables", self.merge())
        alone = self.folder / "alone.csv"
        self.sweep("--out", alone.name)
        self.assertEqual(len(rows(alone)), 13)
        self.assertEqual(rows(self.table), rows(alone))

    def test_all_tasks_together_make_the_table_of_one_machine(self):
        job = self.submit()
        self.until_ended(job)
        self.check_merged()
        for task in (1, 2, 3):
            self.assertIn(f"share {task}/3", self.log(task))
            self.assertIn(f"{job}_{task}", self.log(task))

    def test_a_script_may_be_submitted_from_anywhere_and_again(self):
        self.sweep("--out", self.table, "--slurm", "--tasks", 3)
        for expected in ("4 of 4 runs", "4 of 4 runs, none flown now"):
            said = ran("sbatch", self.table.with_suffix(".sbatch"), cwd="/")
            self.until_ended(said.split()[-1])
            for task in (1, 2, 3):
                self.assertIn(f"share {task}/3, {expected.replace('4 of 4', '4 of 12')}", self.log(task))
        self.check_merged()

    def test_tasks_that_are_queued_again_go_on(self):
        """One because its time is up, another by an administrator: Slurm then waits before it begins them again."""
        for task in (2, 3):
            self.hold(task)
        job = self.submit()
        for task in (2, 3):
            self.until_held(task)
        ran("scancel", "--batch", "--signal=USR1", f"{job}_3")  # the last one has also the number of the whole array
        ran("scontrol", "requeue", f"{job}_2")
        for task in (2, 3):
            self.until(f"task {task} goes on", lambda: "going on: 2 of 4 runs are in the table" in self.log(task))
            self.let_go(task)
        self.until_ended(job)
        for task in (2, 3):
            self.assertIn("interrupted: 2 of 4 runs are in the table", self.log(task))
            self.assertIn(f"job {job}_{task} on node1", self.log(task))
            self.assertIn("start 2\n", self.log(task))
        self.assertEqual([task["Restarts"] for _, task in sorted(self.tasks(job).items())], ["0", "1", "1"])
        self.check_merged()

    def test_a_task_that_was_cancelled_ends_in_order_and_may_go_on(self):
        self.hold(2)
        job = self.submit()
        self.until_held(2)
        ran("scancel", f"{job}_2")
        self.until("task 2 has ended in order", lambda: "interrupted: 2 of 4 runs are in the table" in self.log(2))
        self.let_go(2)
        self.until_ended(job, task_2="CANCELLED")
        self.assertEqual(len(rows(self.share(2))), 3)
        said = ran("sbatch", "--array=2", self.table.with_suffix(".sbatch"))
        self.until("task 2 has ended", lambda: self.tasks(said.split()[-1])["2"]["JobState"] == "COMPLETED")
        self.assertIn("going on: 2 of 4 runs are in the table", self.log(2))
        self.check_merged()

    def test_a_task_of_an_own_script_takes_its_share(self):
        script = self.folder / "own.sh"
        script.write_text('#!/bin/bash\n"$MASCOT_BINARY_DIR/orchestrator" sweep "$@" --no-plot\n')
        logs = str(self.folder).replace("%", "%%") + "/own.%a.log"
        said = ran("sbatch", "--array=11-13", f"--output={logs}", script, self.experiment.name, *SWEEP, "--metric",
                   self.metric.name, "--out", self.table, cwd=self.folder)
        self.until_ended(said.split()[-1])
        self.check_merged()


class Run(unittest.TestCase):
    def test_is_spread_over_the_nodes_of_a_job_with_the_bytes_of_one_machine(self):
        orchestrator = f'{os.environ["MASCOT_BINARY_DIR"]}/orchestrator'
        few = ["--set", "run.duration_s=0.5", "--set", "output.save_plot=false", "--quiet"]
        with tempfile.TemporaryDirectory(prefix="mascot-slurm-") as folder:
            config = ROOT / "configs/formation.toml"
            up = shlex.join([orchestrator, "up", str(config), "--slurm", "--out", "spread", *few])
            ran(CLUSTER, "--nodes", "3", "sbatch", "--wait", "--nodes=3", "--ntasks=5", "--output=log", "--wrap", up,
                cwd=folder)  # 3 processors of a node, and one of each other
            ran(orchestrator, "up", config, "--engine", "inprocess", "--out", "one", *few, cwd=folder)
            spread, one = pathlib.Path(folder, "spread"), pathlib.Path(folder, "one")
            self.assertEqual((spread / "run.mcap").read_bytes(), (one / "run.mcap").read_bytes())
            hosts = re.findall('^name = "(node[0-9])"$', (spread / "config.toml").read_text(), re.MULTILINE)
            self.assertEqual(hosts, ["node1", "node2", "node3"])
            said = (spread / "logs/agent_1.log").read_text()
            self.assertTrue(said.startswith("hears "), said)

    def test_goes_on_without_a_node_of_its_job(self):
        orchestrator = f'{os.environ["MASCOT_BINARY_DIR"]}/orchestrator'
        sets = ["run.duration_s=600", "run.pace=1", "run.agent_timeout_s=5", "run.on_agent_loss=hold",
                "output.save_plot=false"]
        with tempfile.TemporaryDirectory(prefix="mascot-slurm-") as folder:
            script = pathlib.Path(folder, "without_node2.py")
            script.write_text(WITHOUT_NODE2)
            up = [orchestrator, "up", ROOT / "configs/formation.toml", "--slurm", "--out", "spread"]
            up += [word for key in sets for word in ("--set", key)]
            job = shlex.join(str(word) for word in [sys.executable, script, *up])
            ran(CLUSTER, "--nodes", "3", "sbatch", "--wait", "--nodes=3", "--output=log", "--wrap", job, cwd=folder,
                code=130)
            said = pathlib.Path(folder, "up.err").read_text()
            lost = re.findall("^lost: agent_([0-9]+) was on host node2, which has not been heard of for 3 s$", said,
                              re.MULTILINE)
            config = pathlib.Path(folder, "spread/config.toml").read_text()
            node2 = re.search('^name = "node2"\nagents = "([0-9-]+)"$', config, re.MULTILINE)
            self.assertEqual(f"{lost[0]}-{lost[-1]}", node2[1], said)
            self.assertIn("the same, bit for bit", ran(orchestrator, "verify", "spread", cwd=folder))


class Page(unittest.TestCase):
    def test_commands_do_what_it_says(self):
        """Those of the section on Slurm of docs/hosts.md, in a cluster of their own: job 1 is on the page."""
        told = [command for section, language, _, text in tour_test.blocks((ROOT / "docs/hosts.md").read_text())
                if section.startswith("Slurm") and language == "console" for command in tour_test.commands(text)]
        self.assertGreater(len(told), 4)
        script = "\n".join(f"{command} 2>&1 || exit\necho {END}" for command, _ in told)
        path = f'{os.environ["MASCOT_BINARY_DIR"]}:{os.environ["PATH"]}'
        with tempfile.TemporaryDirectory(prefix="mascot-slurm-") as folder:
            shutil.copy(ROOT / "configs/leaderless.toml", f"{folder}/mine.toml")
            done = subprocess.run([CLUSTER, "bash", "-c", script], cwd=folder, env={**os.environ, "PATH": path},
                                  capture_output=True, text=True, timeout=TOTAL_LIMIT_S)
            logs = "".join(f"--- {log}\n{log.read_text()}" for log in sorted(pathlib.Path(folder).glob("*.log")))
        for (command, wanted), output in itertools.zip_longest(told, done.stdout.split(f"{END}\n")[:-1], fillvalue=""):
            self.assertTrue(tour_test.fits(output, wanted), f"$ {command}\n{output}\n{done.stdout}{done.stderr}{logs}")
        self.assertEqual(done.returncode, 0)


if __name__ == "__main__":
    if INSIDE not in sys.argv:
        if reason := in_slurm.why_not():
            print(f"slurm_test: skipped: {reason}")
            sys.exit(SKIPPED)
        in_slurm.outside(1, [sys.executable, __file__, INSIDE, *sys.argv[1:]])
    sys.argv.remove(INSIDE)
    unittest.main()
