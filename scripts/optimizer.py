#!/usr/bin/python3 -Es
"""Proposes the values that `orchestrator tune` tries next, by Optuna's tree-structured Parzen estimator.

Reads lines of JSON and answers each with one. The first describes the search:

    {"seed": 0, "maximize": false, "keys": [{"min": 0.1, "max": 1, "log": true}, {"choices": ["ring", "path"]}],
     "first": [0.5, "ring"]}                            answer: "optuna 3.1.0"

"first", the candidate to begin with, may be null. Then, in turn:

    {"ask": 4}                                          answer: 4 candidates, each a list with a value for each key
    {"tell": [1.5, null, 0.2, 3.1]}                     answer: null

A told null is a candidate without a value: worse than all others. The same lines get the same answers.
Exit codes: 0 at the end of the input, 1 if Optuna is missing.
"""

import json
import math
import sys
import warnings

try:
    import optuna
except ImportError as error:
    print(f"error: tune needs Optuna (Debian: apt-get install python3-optuna): {error}", file=sys.stderr)
    sys.exit(1)


def distribution(key):
    if "choices" in key:
        return optuna.distributions.CategoricalDistribution(key["choices"])
    return optuna.distributions.FloatDistribution(key["min"], key["max"], log=key["log"])


class Search:
    def __init__(self, said):
        # Candidates of a batch know of each other (constant_liar); keys are drawn together, not one by one (multivariate).
        sampler = optuna.samplers.TPESampler(seed=said["seed"], multivariate=True, constant_liar=True)
        self.worst = -math.inf if said["maximize"] else math.inf
        self.study = optuna.create_study(sampler=sampler, direction="maximize" if said["maximize"] else "minimize")
        self.keys = {str(place): distribution(key) for place, key in enumerate(said["keys"])}
        if said["first"] is not None:
            self.study.enqueue_trial(dict(zip(self.keys, said["first"])))
        self.asked = []

    def answer(self, said):
        if "ask" in said:
            self.asked = [self.study.ask(self.keys) for _ in range(said["ask"])]
            return [[trial.params[key] for key in self.keys] for trial in self.asked]
        for trial, value in zip(self.asked, said["tell"], strict=True):
            self.study.tell(trial, self.worst if value is None else value)
        return None


def main():
    warnings.simplefilter("ignore")  # options of the sampler that may still change in Optuna
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    search = None
    for line in sys.stdin:
        said = json.loads(line)
        if search is None:
            search = Search(said)
            answer = f"optuna {optuna.__version__}"
        else:
            answer = search.answer(said)
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
