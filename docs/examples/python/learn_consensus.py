#!/usr/bin/python3
"""Six quadrotors learn to meet, though a fifth of what they tell each other is lost, and beat the linear law of six.toml.

  docs/examples/python/learn_consensus.py policy.onnx 150      with PYTHONPATH=build/release/python; 20 generations: a short form
  orchestrator sweep docs/examples/python/six.toml --set 'law={name="policy", file="policy.onnx"}' --seeds 3001..3100
The sweep says 4.32 s (mean consensus.settling_time_s, starts not seen before); without --set, of the tuned linear law, 4.98 s.
Evolution strategies: a generation flies ten random changes of the weights and their opposites, all from the start of one seed, and
the weights move towards the changes with which the team met sooner. They begin at random, and know nothing of the linear law."""
import pathlib
import sys

import mascot
import onnx
import torch

if len(sys.argv) != 3:
    sys.exit(__doc__)
FILE, GENERATIONS, CHANGES, TICKS, SHAPES = sys.argv[1], int(sys.argv[2]), 10, 600, [(2, 8), (9, 8), (8, 1)]


class Policy(torch.nn.Module):
    """a = 3 tanh(w3 tanh(w2 [mean over j of heard_j tanh(w1 [p_ij, v_ij]), v])), for each axis: at most 3 m/s^2."""
    def __init__(self, weights):
        super().__init__()
        self.count, parts = len(weights), weights.split([n * m for n, m in SHAPES], 1)
        self.weights = [part.reshape(-1, 1, *shape) for part, shape in zip(parts, SHAPES)]

    def forward(self, observations):  # each row of weights answers as many of the observations
        (w1, w2, w3), rows = self.weights, observations.reshape(self.count, -1, 55)
        v, others = rows[..., 3:6, None] / 4, rows[..., 10:].reshape(self.count, -1, 5, 9)
        motions = torch.stack([others[..., 0:3], others[..., 3:6]], -1) / 4
        pull = (others[..., 7:8, None] * torch.tanh(motions @ w1[:, None])).mean(2)
        return 3 * torch.tanh(torch.tanh(torch.cat([pull, v], -1) @ w2) @ w3).reshape(-1, 3)


def fly(weights, seeds):  # the disagreement (m) at each tick of each team
    policy, (observations, _), disagreement = Policy(weights), envs.reset(seed=seeds), []
    for _ in range(TICKS):
        observations, rewards, *_ = envs.step(policy(torch.from_numpy(observations)).reshape(envs.action_space.shape))
        disagreement.append(torch.from_numpy(-rewards))
    return torch.stack(disagreement).float()


torch.manual_seed(0), torch.set_num_threads(1), torch.set_grad_enabled(False)
envs = mascot.vector_env(pathlib.Path(__file__).with_name("six.toml"), 2 * CHANGES)
weights, best_s = torch.cat([torch.randn(1, n * m) / n**0.5 for n, m in SHAPES], 1), float("inf")
adam = torch.optim.Adam([weights], lr=0.05)
for generation in range(GENERATIONS + 1):
    if generation % 10 == 0:  # flown from 20 other starts: the best there is what is written
        is_apart = (d := fly(weights, range(501, 521))) > 0.02 * d[0]
        settled_s = float(is_apart.flip(0).cumsum(0).sign().sum(0).float().mean()) / 100
        print(f"generation {generation}: settles in {settled_s:.2f} s", flush=True)
        best, best_s = (weights.clone(), settled_s) if settled_s < best_s else (best, best_s)
    change = 0.1 * torch.randn(CHANGES, weights.shape[1])
    cost = (fly(torch.cat([weights + change, weights - change]), [generation] * 2 * CHANGES) + 0.02).log().mean(0)
    weights.grad = (cost[:CHANGES] - cost[CHANGES:])[None] @ change / cost.std()
    adam.step()
torch.onnx.export(Policy(best), torch.zeros(1, 55), FILE, opset_version=17)
onnx.helper.set_model_props(model := onnx.load(FILE), {"mascot_observation": envs.observation_layout["hash"]})
onnx.save(model, FILE)
