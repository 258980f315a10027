#!/usr/bin/python3
"""random_predictions.py [--model M,...] [--law L,...] [--count N] [--seed S]: are the predictions of laws true?

Makes random, reasonable experiments of each law and each model, flies each in one process, and holds every prediction
against what was measured: figures of the law (`laws.LAW` of summary.json), meeting point, settling time, decay rate.
Prints, by law and model, how many experiments there were, of how many theory predicts something, how many predictions
there were, and how many are broken; then each broken one. Not part of the tests: a thousand experiments take minutes.

The same seed gives the same experiments, also of a law alone. Those with a broken prediction are kept (--keep).

What is equal: a figure within 2 % (--equal) and, by its unit, 1 mm, 2 ticks or 0.001 of what is predicted; a meeting
point within 2 % of how far the agents were apart; a settling time within 5 % and 2 ticks; a rate within 10 %. Where
`check` warns that the run is too short, the meeting point is not held, nor a time after the end. Bounds
may be passed by 1e-9 of themselves. A rate that is predicted and not measured is not broken. Predictions on average
(docs/theory.md) are not held against a single run.
"""

import argparse
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODELS = ("quadrotor", "double_integrator", "single_integrator", "unicycle")
LONGEST_S = 300  # of a run, which takes a second or so
UNDIRECTED = ("path", "ring", "star", "complete", "wheel", "binary_tree")
UNMEASURED = {"least_headway_s"}  # what is said of other experiments than the one that is flown
ACCELERATES = {"trajectory", "platoon", "flocking", "waypoint", "consensus", "formation"}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default=",".join(MODELS), help="models, with commas between; default: all")
    parser.add_argument("--law", default=",".join(LAWS), help="laws, with commas between; default: all that are known")
    parser.add_argument("--count", type=int, default=25, help="experiments of each law and model")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--equal", type=float, default=0.02, help="relative tolerance of what is predicted as equal")
    parser.add_argument("--keep", type=pathlib.Path, default=pathlib.Path("broken_predictions"), metavar="FOLDER")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--set", action="append", default=[], dest="sets", metavar="KEY=VALUE", help="in every file")
    parser.add_argument("--silent", action="store_true", help="print why theory is silent, and how often, as well")
    return parser.parse_args()


# --- TOML


def value(v):
    if isinstance(v, bool):
        return "true" if v else "false"
    if isinstance(v, str):
        return json.dumps(v)
    if isinstance(v, (list, tuple)):
        return "[" + ", ".join(value(x) for x in v) + "]"
    if isinstance(v, dict):
        return "{ " + ", ".join(f"{k} = {value(x)}" for k, x in v.items()) + " }"
    return repr(round(v, 6)) if isinstance(v, float) else repr(v)


def document(tables):
    return "\n".join(f"[{name}]\n" + "".join(f"{key} = {value(v)}\n" for key, v in table.items())
                     for name, table in tables.items() if table)


# --- experiments


class Draw(random.Random):
    """Random values of experiments."""

    def log(self, low, high):
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def vector(self, size, z=0.0):
        return [self.uniform(-size, size), self.uniform(-size, size), z]

    def chance(self, share):
        return self.random() < share


def scattered(draw, count, size, height_step=1.0):
    """Places within `size` of the origin along x and y, each at a height of its own."""
    heights = [1.5 + height_step * i for i in range(count)]
    draw.shuffle(heights)
    return [draw.vector(size, z) for z in heights]


def ring_of(count, radius, draw, height_step=1.0):
    """Places on a circle, each moved at random by up to a quarter of the radius."""
    places = scattered(draw, count, radius / 4, height_step)
    for i, place in enumerate(places):
        place[0] += radius * math.cos(2 * math.pi * i / count)
        place[1] += radius * math.sin(2 * math.pi * i / count)
    return places


def undirected(draw, count):
    return {"topology": draw.choice([t for t in UNDIRECTED if not (t in ("wheel", "ring") and count < 4)])}


def agreement(keys):
    def make(draw, count):
        return keys(draw), undirected(draw, count), scattered(draw, count, draw.log(1, 6)), draw.choice([10, 20, 30])

    return make


def finite_time(draw):
    form = draw.choice(["sign", "power"])
    return {"form": form, "gain": draw.log(0.1, 1.5)} | ({"alpha": draw.uniform(0.2, 0.9)} if form == "power" else {})


def prescribed_time(draw):
    return {"time_s": draw.uniform(3, 10), "exponent": draw.uniform(2, 10), "gain": draw.log(0.05, 0.5)}


def event_triggered(draw):
    if draw.chance(0.3):
        return {"gain": draw.log(0.1, 1), "trigger": "dynamic"}
    return {"gain": draw.log(0.1, 2), "c0_m": draw.log(0.002, 0.1), "c1_m": draw.choice([0.0, 0.2]),
            "alpha": draw.log(0.1, 0.5)}


def containment(draw, count):
    count = max(count, 4)
    leaders = list(range(1, draw.randint(1, count - 2) + 1))
    law = {"gain": draw.log(0.2, 2), "leaders": leaders}
    if draw.chance(0.5):
        law["leader_velocities_m_per_s"] = [draw.vector(0.5)]
    return law, undirected(draw, count), scattered(draw, count, 6), draw.choice([15, 30])


def rendezvous(draw, count):
    reach = draw.uniform(3, 6)
    places = scattered(draw, count, 1)
    for i, place in enumerate(places):
        place[0] += i * reach * draw.uniform(0.5, 0.8)
    return {"gain": draw.log(0.1, 1), "margin_m": reach * 0.1}, {"range_m": reach}, places, draw.choice([15, 30])


def average_tracking(draw, count):
    law = {"gain": draw.log(1, 8), "p_gain": draw.log(0.2, 1.5), "inputs_m": [draw.vector(3, 3.0) for _ in range(count)],
           "amplitudes_m": [draw.vector(2) for _ in range(count)],
           "frequencies_hz": [draw.uniform(0.01, 0.08)] * count if draw.chance(0.5) else
           [draw.uniform(0.01, 0.08) for _ in range(count)]}
    return law | {"shape": "circle", "spacing_m": 2.0}, undirected(draw, count), ring_of(count, 5, draw), 30


def gradient_tracking(draw, count):
    law = {"step": draw.log(0.005, 0.03), "p_gain": draw.log(0.2, 1.5),
           "targets_m": [draw.vector(4) for _ in range(count)], "weights": [[draw.log(0.3, 2)] for _ in range(count)]}
    return law, undirected(draw, count), scattered(draw, count, 5), 30


def cyclic_pursuit(draw, count):
    count = max(count, 3)
    alpha = draw.choice([0.0, 180 / count, draw.uniform(0, 180 / count)])
    return ({"gain": draw.log(0.1, 1), "alpha_deg": alpha}, {"topology": "ring"}, ring_of(count, draw.uniform(2, 5), draw),
            draw.choice([15, 30]))


def distance_formation(draw, count):
    law = {"shape": "circle", "spacing_m": draw.uniform(1.5, 3), "gain": draw.log(0.01, 0.06)}
    return law, {"topology": "complete"}, ring_of(count, 4, draw), draw.choice([20, 40])


def bearing_formation(draw, count):
    count = max(count, 3)
    return {"shape": "circle", "gain": draw.log(0.3, 2)}, {"topology": "complete"}, ring_of(count, 4, draw), 40


def affine_formation(draw, count):
    count = max(count, 4)
    law = {"shape": "circle", "spacing_m": 2.0, "leaders": [1, 2, 3], "gain": draw.log(0.1, 1)}
    if draw.chance(0.6):
        law |= {"times_s": [0, 20], "shifts_m": [[0, 0, 0], draw.vector(6)], "turns_deg": [0, draw.choice([0, 60])]}
    return law, {"topology": "complete"}, ring_of(count, 1.0 / math.sin(math.pi / count), draw), 40


def resilient(draw, count):
    count = max(count, 4)
    law = {"f": draw.choice([0, 1]) if count > 4 else 0, "gain": draw.log(0.05, 0.5)}
    return law, {"topology": "complete"}, scattered(draw, count, 4), 30


def trajectory(draw, count):
    radius, period = draw.uniform(1, 4), draw.uniform(8, 30)
    law = {"path": draw.choice(["circle", "figure_eight"]), "radius_m": radius, "period_s": period,
           "p_gain": draw.log(0.5, 3), "d_gain": draw.log(0.5, 3), "feed_forward": draw.chance(0.6),
           "centre_m": [0, 0, 2]}
    places = scattered(draw, count, 1, 1.0)
    if count > 1:
        law |= {"shape": draw.choice(["circle", "line", "grid"]), "spacing_m": 2.0}
        for i, place in enumerate(places):
            place[0] += radius + 2.0 * i
    else:
        places[0][0] += radius
    return law, {}, places, 40


def platoon(draw, count):
    speed, spacing, headway = draw.uniform(0.5, 5), draw.uniform(2, 4), draw.uniform(0.1, 1.5)
    law = {"spacing_m": spacing, "headway_s": headway, "p_gain": draw.log(0.3, 2), "d_gain": draw.log(0.5, 2),
           "speed_m_per_s": speed, "disturbance_m_per_s": draw.uniform(0.05, 0.4), "disturbance_period_s": draw.uniform(4, 15)}
    return law, {"topology": "directed_path"}, [[-i * (spacing + headway * speed), 0, 2] for i in range(count)], 50, \
        [[speed, 0, 0]] * count


def apart(draw, count, size, least):
    """Places at one height, each at least `least` from all others."""
    places = []
    while len(places) < count:
        place = draw.vector(size, 2.0)
        if all(math.dist(place, other) >= least for other in places):
            places.append(place)
    return places


def pursuit_evasion(draw, count):
    law = {"leader": 1, "pursuer_speed_m_per_s": draw.uniform(0.5, 1), "evader_speed_m_per_s": draw.uniform(0, 0.4)}
    return law, {"topology": "star"}, apart(draw, count, 6, 1.5), 20


def coverage(draw, count):
    size = draw.uniform(6, 12)
    law = {"region_m": [[0, 0], [size, 0], [size, 0.7 * size], [0, size]], "gain": draw.log(0.2, 1)}
    places = [[draw.uniform(0.1, 0.6) * size, draw.uniform(0.1, 0.6) * size, 1.5 + i] for i in range(count)]
    return law, {}, places, 20


def flocking(draw, count):
    law = {"distance_m": draw.uniform(2, 4), "c1_alpha": draw.log(0.2, 1), "c2_alpha": draw.log(0.3, 1.5),
           "c1_gamma": draw.log(0.05, 0.3), "c2_gamma": draw.log(0.3, 1), "target_m": [0, 0, 2],
           "target_velocity_m_per_s": draw.vector(0.5)}
    places = ring_of(count, 0.4 * law["distance_m"] * count / 2, draw, 0.0)
    return law, {}, places, 20, [draw.vector(0.3) for _ in range(count)]


def avoidance(draw, count):
    law = {"gain": draw.log(0.3, 1.5), "speed_m_per_s": draw.uniform(0.3, 1), "repulsion": draw.log(0.1, 0.6),
           "influence_m": draw.uniform(1.2, 2)}
    places = [[0, 4.0 * i, 2] for i in range(count)]
    law["goals_m"] = [[12, 4.0 * i + draw.uniform(-1, 1), 2] for i in range(count)]
    obstacles = [{"shape": "cylinder", "position_m": [6 + draw.uniform(-1, 1), 4.0 * i + draw.uniform(-1, 1), 3],
                  "size_m": [0.8, 0.8, 6]} for i in range(0, count, 3)]
    return law, {"edges": []}, places, 30, None, {"physics": {"obstacles": obstacles}, "sensors": {"range_m": 3.0}}


def consensus(draw, count):
    law = {"p_gain": draw.log(0.1, 1.5), "beta": draw.log(0.5, 3)}
    return law, undirected(draw, count), scattered(draw, count, 4), 30


def velocity_consensus(draw, count):
    return {"p_gain": draw.log(0.1, 1)}, undirected(draw, count), scattered(draw, count, 4), 30


def formation(draw, count):
    law = {"shape": "circle", "spacing_m": 2.0, "p_gain": draw.log(0.1, 1), "beta": draw.log(0.5, 3)}
    return law, undirected(draw, count), ring_of(count, 4, draw), 30


def waypoint(draw, count):
    law = {"waypoints_m": [draw.vector(2, 2.0) for _ in range(draw.randint(1, 3))],
           "p_gain": draw.log(0.1, 0.8), "d_gain": draw.log(0.5, 3)}
    return law, {}, [draw.vector(2, 2.0 + i) for i in range(count)], 40, None, {"physics": {"collisions": False}}


# What is made of a law: law table, graph table, places, duration (s), and perhaps velocities and more tables.
LAWS = {
    "finite_time": agreement(finite_time),
    "prescribed_time": agreement(prescribed_time),
    "event_triggered": agreement(event_triggered),
    "containment": containment,
    "rendezvous": rendezvous,
    "average_tracking": average_tracking,
    "gradient_tracking": gradient_tracking,
    "cyclic_pursuit": cyclic_pursuit,
    "distance_formation": distance_formation,
    "bearing_formation": bearing_formation,
    "affine_formation": affine_formation,
    "resilient": resilient,
    "trajectory": trajectory,
    "platoon": platoon,
    "pursuit_evasion": pursuit_evasion,
    "coverage": coverage,
    "flocking": flocking,
    "avoidance": avoidance,
    "consensus": consensus,
    "velocity_consensus": velocity_consensus,
    "formation": formation,
    "waypoint": waypoint,
}


def experiment(law, model, seed, number):
    """The text of an experiment."""
    draw = Draw(f"{law} {model} {seed} {number}")
    made = LAWS[law](draw, draw.randint(2, 8))
    keys, graph, places, duration = made[:4]
    velocities = made[4] if len(made) > 4 else None
    tables = {"run": {"duration_s": float(duration), "seed": number}, "physics": {"collisions": draw.chance(0.5)},
              "agents": {"count": len(places), "model": model, "position_m": places},
              "control": {"rate_hz": draw.choice([100, 100, 100, 50, 200])}, "sensors": {}, "link": {}}
    if velocities and (law in ACCELERATES) and model != "unicycle":
        tables["agents"]["velocity_m_per_s"] = velocities
    if model == "quadrotor" and draw.chance(0.4):
        tables["agents"]["airframe"] = draw.choice(["crazyflie", "crazyflie", "mascot_published"])
    if draw.chance(0.1):
        tables["link"]["delay_s"] = draw.choice([0.02, 0.05, 0.1])
    if draw.chance(0.05):
        tables["sensors"]["own"] = {"position_std_m": 0.005}
    for name, more in (made[5] if len(made) > 5 else {}).items():
        tables[name] = tables.get(name, {}) | more
    tables["graph"] = graph
    tables["law"] = {"name": law} | keys
    return document(tables)


# --- runs


def fly(programs, text, sets, folder, name):
    """summary.json of an experiment, and whether `up` warns that it is too short; or the words of its failure."""
    path = pathlib.Path(folder) / f"{name}.toml"
    path.write_text(text)
    out = pathlib.Path(folder) / name
    words = [programs / "orchestrator", "up", path, "--engine", "inprocess", "--out", out]
    for key in ("output.save_plot=false", "output.save_data=false", "output.fidelity=false", *sets):
        words += ["--set", key]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=LONGEST_S)
        if done.returncode != 0:
            return done.stderr.strip()
        summary = json.loads((out / "summary.json").read_text())
    except subprocess.TimeoutExpired:
        return f"took longer than {LONGEST_S} s"
    finally:
        shutil.rmtree(out, ignore_errors=True)
    return summary | {"is_short": "warning: run.duration_s: the run ends after" in done.stdout + done.stderr}


# --- judging


def floor(name, tick_s):
    """What a difference of a figure may be, whatever its size."""
    if name.endswith("_time_s"):
        return 2 * tick_s
    return 1e-3


def broken_value(name, bound, predicted, tolerance, measured, equal, tick_s, end_s):
    """Why one prediction is broken; None: it is not."""
    if measured is None and name.startswith("rate"):
        return None  # it is measured only where there is enough of a decay
    if measured is None and name.endswith("_time_s") and predicted > end_s:
        return None  # the run ends before that
    if measured is None:
        return f"{name}: predicted {bound} {predicted:.6g}, measured none"
    slack = 1e-9 * abs(predicted) + 1e-12
    holds = {"equal": lambda: abs(measured - predicted) <= equal * abs(predicted) + floor(name, tick_s),
             "at_most": lambda: measured <= predicted + slack,
             "at_least": lambda: measured >= predicted - slack,
             "within": lambda: abs(measured - predicted) <= tolerance + slack}[bound]()
    if holds:
        return None
    width = f" +- {tolerance:.6g}" if bound == "within" else ""
    return f"{name}: predicted {bound} {predicted:.6g}{width}, measured {measured:.6g}"


def judged_figures(summary, equal):
    """Every prediction of a figure, as the reason why it is broken or None."""
    tick_s = summary["sim_s"] / max(1, summary["ticks"])
    for law in summary.get("laws", {}).values():  # consensus and its kin have no figures
        for name, predicted in law["predicted"].items():
            if name in UNMEASURED:
                continue
            bound, tolerance = law["bounds"][name], law.get("tolerances", {}).get(name)
            several = isinstance(predicted, list)
            rows = zip(predicted, tolerance or [None] * len(predicted), law[name]) if several else \
                [(predicted, tolerance, law[name])]
            for of_theory, width, measured in rows:
                if of_theory is not None:
                    yield broken_value(name, bound, of_theory, width, measured, equal, tick_s, summary["sim_s"])


def judged_team(summary):
    """Likewise the meeting point, settling time and rate."""
    consensus_, tick_s = summary["consensus"], summary["sim_s"] / max(1, summary["ticks"])
    predicted, deviation = consensus_["predicted"], consensus_["deviation"]
    if predicted["on_average"]:
        return
    if predicted["value_m"] is not None and deviation["value_m"] is not None and not summary["is_short"]:
        yield deviation["value_m"], 0.02 * summary["spread_m"] + 1e-3, "value_m", predicted["value_m"]
    if predicted["settling_time_s"] is not None and deviation["settling_time_s"] is not None:
        expected = predicted["settling_time_s"]
        yield deviation["settling_time_s"], 0.05 * expected + 2 * tick_s, "settling_time_s", expected
    if predicted["rate_per_s"] is not None and deviation["rate_per_s"] is not None:
        yield deviation["rate_per_s"], 0.1 * predicted["rate_per_s"], "rate_per_s", predicted["rate_per_s"]


def judge(summary, equal):
    """Number of predictions; the broken ones in words."""
    reasons = list(judged_figures(summary, equal))
    for off, most, name, expected in judged_team(summary):
        reasons.append(f"{name}: predicted {expected}, off by {off:.6g}" if abs(off) > most else None)
    return len(reasons), [reason for reason in reasons if reason]


def cut_or_touched(summary):
    control = summary["control"]
    shares = [control["saturated_fraction"], control["tilt_limited_fraction"], control["rotor_limited_fraction"]]
    words = [word for word, share in zip(("acceleration cut", "tilt cut", "rotors cut"), shares) if share]
    return ", ".join(words + (["contacts"] if summary["safety"]["collisions"] else []))


class Tally:
    """What became of the experiments of a law and a model."""

    def __init__(self):
        self.flown = self.speaking = self.predictions = self.broken = self.failed = 0
        self.silent = collections.Counter()


def spread_of(text):
    places = json.loads(next(line for line in text.splitlines() if line.startswith("position_m")).split("=", 1)[1])
    return max(math.dist(a, b) for a in places for b in places)


def main():
    args = arguments()
    table = collections.defaultdict(Tally)
    all_broken, failures = [], []
    tasks = [(law, model, number) for law in args.law.split(",") for model in args.model.split(",")
             for number in range(args.count)]
    for law in {law for law, _, _ in tasks} - set(LAWS):
        sys.exit(f"{law}: expected one of {', '.join(LAWS)}")

    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:

        def one(task):
            law, model, number = task
            text = experiment(law, model, args.seed, number)
            return task, text, fly(args.programs, text, args.sets, folder, f"{law}-{model}-{args.seed}-{number}")

        for (law, model, number), text, summary in pool.map(one, tasks):
            tally, name = table[law, model], f"{law}-{model}-{args.seed}-{number}"
            if isinstance(summary, str):
                tally.failed += 1
                failures.append(f"{name}: {summary.splitlines()[0] if summary else 'failed without a word'}")
                continue
            summary["spread_m"] = spread_of(text)
            count, broken = judge(summary, args.equal)
            predicted = summary["consensus"]["predicted"]
            tally.flown += 1
            tally.speaking += count > 0
            tally.predictions += count
            tally.broken += len(broken)
            if count == 0:
                tally.silent[predicted["silent"] or predicted["figures_silent"] or "it says only that it is stable"] += 1
            if broken:
                args.keep.mkdir(parents=True, exist_ok=True)
                (args.keep / f"{name}.toml").write_text(text)
                why = cut_or_touched(summary)
                all_broken += [f"{name}: {reason}{f' ({why})' if why else ''}" for reason in broken]

    print(f"{'law':<20} {'model':<18} {'flown':>6} {'speaks':>7} {'share':>6} {'predictions':>12} {'broken':>7} {'failed':>7}")
    total = Tally()
    for (law, model), tally in sorted(table.items(), key=lambda row: (row[0][1], row[0][0])):
        share = f"{100 * tally.speaking / tally.flown:.0f} %" if tally.flown else "-"
        print(f"{law:<20} {model:<18} {tally.flown:>6} {tally.speaking:>7} {share:>6} {tally.predictions:>12} "
              f"{tally.broken:>7} {tally.failed:>7}")
        for field in ("flown", "speaking", "predictions", "broken", "failed"):
            setattr(total, field, getattr(total, field) + getattr(tally, field))
        for reason, times in tally.silent.most_common() if args.silent else ():
            print(f"    {times:>4} x silent, because {reason}")
    share = f"{100 * total.speaking / total.flown:.0f} %" if total.flown else "-"
    print(f"{'all':<20} {'':<18} {total.flown:>6} {total.speaking:>7} {share:>6} {total.predictions:>12} "
          f"{total.broken:>7} {total.failed:>7}")
    for words in all_broken:
        print(f"broken: {words}")
    for words in failures:
        print(f"failed: {words}")
    return 1 if all_broken else 0


if __name__ == "__main__":
    sys.exit(main())
