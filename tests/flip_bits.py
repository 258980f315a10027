#!/usr/bin/python3
"""flip_bits.py DOMAIN [--seed N] [--share X] [--flips N]: an attacker on the loopback interface, for tests.

Sees the RTPS datagrams of a DDS domain on 127.0.0.1, flips bits in copies of them, and sends the copies to where the
originals went, until it is killed. Needs the right to open packet sockets (root).
"""

import argparse
import random
import socket
import struct
import sys

PORT_BASE, PORTS_PER_DOMAIN = 7400, 250  # RTPS 2.2, section 9.6.1
ALL_PROTOCOLS = 3
ETHERNET, UDP, OUTGOING = 14, 17, 4


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("domain", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=0.2, help="share of the datagrams that are forged")
    parser.add_argument("--flips", type=int, default=3, help="largest number of bits flipped in one")
    return parser.parse_args()


def datagram(frame, first_port):
    """Destination and payload of an RTPS datagram of the domain; nothing if `frame` holds none."""
    ip = frame[ETHERNET:]
    if len(ip) < 28 or ip[0] >> 4 != 4 or ip[9] != UDP:
        return None
    udp = ip[(ip[0] & 15) * 4 :]
    port = struct.unpack("!H", udp[2:4])[0]
    payload = udp[8:]
    if not first_port <= port < first_port + PORTS_PER_DOMAIN or payload[:4] != b"RTPS":
        return None
    return (socket.inet_ntoa(ip[16:20]), port), payload


def flipped(payload, dice, flips):
    forged = bytearray(payload)
    for _ in range(dice.randint(1, flips)):
        bit = dice.randrange(8 * len(forged))
        forged[bit // 8] ^= 1 << bit % 8
    return bytes(forged)


def main():
    args = arguments()
    dice = random.Random(args.seed)
    ears = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(ALL_PROTOCOLS))
    ears.bind(("lo", 0))
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    mouth.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
    own_port, forged = None, 0
    while True:
        frame, address = ears.recvfrom(65536)
        if address[2] == OUTGOING:  # the loopback interface shows each frame twice
            continue
        found = datagram(frame, PORT_BASE + PORTS_PER_DOMAIN * args.domain)
        source = struct.unpack("!H", frame[ETHERNET + 20 : ETHERNET + 22])[0]
        if found is None or source == own_port or dice.random() >= args.share:
            continue
        mouth.sendto(flipped(found[1], dice, args.flips), found[0])
        own_port = mouth.getsockname()[1]
        forged += 1
        if forged % 1000 == 0:
            print(f"{forged} datagrams forged", file=sys.stderr)


if __name__ == "__main__":
    main()
