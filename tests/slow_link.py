#!/usr/bin/python3
"""slow_link.py NAME DELAY_MS LOSS NAMESPACE_A NAMESPACE_B: a cable between two network namespaces, each with an end called
NAME, that delivers each frame DELAY_MS later and loses a fraction LOSS of them, drawn from a fixed seed: what `tc netem`
does where the kernel has it. Needs root; ends with its standard input, and the cable with it."""
import fcntl
import heapq
import os
import random
import select
import struct
import subprocess
import sys
import time

LIMIT_S = 60  # of a command
TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000


def end(name, namespace):
    """A network interface in a namespace, and the file with its frames."""
    file = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    made = f"t{os.getpid()}"  # there is none of this name here
    fcntl.ioctl(file, TUNSETIFF, struct.pack("16sH", made.encode(), IFF_TAP | IFF_NO_PI))
    subprocess.run(["ip", "link", "set", made, "netns", namespace, "name", name], check=True, timeout=LIMIT_S)
    return file


def relay(ends, delay_s, loss):
    draw = random.Random(1)
    late = []  # (when, number, where to, frame)
    number = 0
    while True:
        wait = max(0, late[0][0] - time.monotonic()) if late else None
        ready, _, _ = select.select([*ends, sys.stdin], [], [], wait)
        now = time.monotonic()
        if sys.stdin in ready and not os.read(0, 1):
            return
        for k, file in enumerate(ends):
            while file in ready:
                try:
                    frame = os.read(file, 65536)
                except BlockingIOError:
                    break
                except OSError:  # that end is not up
                    time.sleep(0.01)
                    break
                number += 1
                if draw.random() >= loss:
                    heapq.heappush(late, (now + delay_s, number, ends[1 - k], frame))
        while late and late[0][0] <= now:
            _, _, file, frame = heapq.heappop(late)
            try:
                os.write(file, frame)
            except OSError:
                pass  # that end is down


def main():
    name, delay_ms, loss, *namespaces = sys.argv[1:]
    ends = [end(name, namespace) for namespace in namespaces]
    print("ready", flush=True)
    relay(ends, float(delay_ms) / 1000, float(loss))


if __name__ == "__main__":
    main()
