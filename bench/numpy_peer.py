#!/usr/bin/python3
"""What quadrotors cost in NumPy, all at once: N of them hover at 1 kHz under a PD law of attitude and height, by
semi-implicit Euler. As bench/peers.cc, without contacts.

  numpy_peer.py AGENTS SECONDS     prints one line of JSON: agent-steps per second
"""

import json
import sys
import time

import numpy as np

DT_S, G, MASS_KG = 0.001, 9.81, 1.477
INERTIA = np.array([0.1152, 0.1152, 0.218])


def rotations(q):
    x, y, z, w = q.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1).reshape(-1, 3, 3)


def step(p, v, q, w, height_m):
    R = rotations(q)
    thrust_n = MASS_KG * (G + 25 * (height_m - p[:, 2]) - 10 * v[:, 2])
    tilt = np.stack([R[:, 2, 1], -R[:, 2, 0], np.zeros(len(p))], axis=1)
    torque = INERTIA * (-625 * tilt - 30 * w)
    v += DT_S * (thrust_n[:, None] * R[:, :, 2] / MASS_KG - [0, 0, G])
    p += DT_S * v
    w += DT_S * (torque - np.cross(w, INERTIA * w)) / INERTIA
    x, y, z, s = q.T
    a, b, c = w.T
    q += DT_S / 2 * np.stack([s * a + y * c - z * b, s * b + z * a - x * c, s * c + x * b - y * a,
                              -x * a - y * b - z * c], axis=1)
    q /= np.linalg.norm(q, axis=1, keepdims=True)


def main():
    agents, seconds = int(sys.argv[1]), float(sys.argv[2])
    height_m = 2.0 + np.arange(agents)
    p, v, w = (np.zeros((agents, 3)) for _ in range(3))
    p[:, 2] = height_m
    q = np.tile([0.0, 0, 0, 1], (agents, 1))
    steps, start = 0, time.perf_counter()
    while (wall_s := time.perf_counter() - start) < seconds:
        for _ in range(10):
            step(p, v, q, w, height_m)
        steps += 10
    assert np.abs(p[:, 2] - height_m).max() < 1e-6, "they hover"
    print(json.dumps({"agent_steps_per_s": round(steps * agents / wall_s)}))


if __name__ == "__main__":
    main()
