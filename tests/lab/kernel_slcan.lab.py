#!/usr/bin/python3
"""A burst of 2,000 frames each way through the kernel's slcan: none is lost, changed or out of order.

The adapter behind the pty is this program. It knows the LAWICEL text format (manual of the CANUSB): tIIIL then L bytes in
hex, T with an identifier of eight digits, each line ended by CR."""

import errno
import os
import random
import select
import socket
import struct
import subprocess
import sys
import threading
import time
import tty
from pathlib import Path

COUNT = 2000
TIMEOUT_S = 40
SEED = 20131104
CAN_FRAME = struct.Struct("=IB3x8s")  # linux/can.h
EXTENDED = 0x80000000
SO_RCVBUFFORCE = 33  # asm-generic/socket.h


def random_frames(rng):
    for _ in range(COUNT):
        extended = rng.random() < 0.5
        identifier = rng.getrandbits(29) | EXTENDED if extended else rng.getrandbits(11)
        yield identifier, rng.randbytes(rng.randint(0, 8))


def line_of(identifier, content):
    name = f"T{identifier & 0x1FFFFFFF:08X}" if identifier & EXTENDED else f"t{identifier:03X}"
    return f"{name}{len(content)}{content.hex().upper()}\r".encode()


class Adapter(threading.Thread):
    """Behind the pty: collects the lines that the kernel writes."""

    def __init__(self, master):
        super().__init__(daemon=True)
        self.master = master
        self.received = b""
        self.ended = threading.Event()

    def run(self):
        while not self.ended.is_set():
            if select.select([self.master], [], [], 0.1)[0]:
                try:
                    self.received += os.read(self.master, 1 << 16)
                except BlockingIOError:
                    pass
                except OSError:
                    return

    def write(self, content):
        """Never blocks: a pty holds about 8 KiB, and the kernel's slcan wakes no writer that waits for room in it."""
        os.set_blocking(self.master, False)
        while content and not self.ended.is_set():
            try:
                content = content[os.write(self.master, content):]
            except BlockingIOError:
                time.sleep(0.001)


def wait_for(condition, what):
    deadline = time.monotonic() + TIMEOUT_S
    while not condition():
        if time.monotonic() > deadline:
            sys.exit(f"found no {what} after {TIMEOUT_S} s")
        time.sleep(0.02)


def send(can, frame):
    """A full queue of the interface is no loss: the sender is asked to wait."""
    deadline = time.monotonic() + TIMEOUT_S
    while True:
        try:
            can.send(frame)
            return
        except OSError as error:
            if error.errno != errno.ENOBUFS or time.monotonic() > deadline:
                raise
            time.sleep(0.001)


def statistics():
    folder = Path("/sys/class/net/slc0/statistics")
    names = ("rx_packets", "rx_dropped", "rx_errors", "rx_over_errors")
    return {name: (folder / name).read_text().strip() for name in names}


def main():
    print(f"seed {SEED}")
    frames = list(random_frames(random.Random(SEED)))
    packed = [CAN_FRAME.pack(identifier, len(content), content.ljust(8, b"\0")) for identifier, content in frames]
    lines = b"".join(line_of(*frame) for frame in frames)

    master, slave = os.openpty()
    tty.setraw(slave)
    adapter = Adapter(master)
    adapter.start()
    # -o and -c: opens and closes the channel; -s8: 1 Mbit/s.
    subprocess.Popen(["slcand", "-F", "-o", "-c", "-s8", os.ttyname(slave), "slc0"], stdout=subprocess.DEVNULL)
    wait_for(lambda: os.path.exists("/sys/class/net/slc0"), "interface slc0")
    subprocess.run(["ip", "link", "set", "slc0", "up"], check=True)
    wait_for(lambda: b"O\r" in adapter.received, "command O, which opens the channel")

    can = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    # The default of 208 KiB holds fewer than 2,000 frames, since each counts with the memory of its buffer.
    can.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 8 << 20)
    can.settimeout(TIMEOUT_S)
    can.bind(("slc0",))

    # From the computer to the bus.
    start = len(adapter.received)
    for frame in packed:
        send(can, frame)
    wait_for(lambda: len(adapter.received) >= start + len(lines), f"{COUNT} lines")
    if adapter.received[start:] != lines:
        sys.exit("found other lines behind the pty, expected the frames that were sent")

    # From the bus to the computer: as fast as the pty takes it.
    threading.Thread(target=adapter.write, args=(lines,), daemon=True).start()
    for number, frame in enumerate(packed):
        try:
            received = can.recv(CAN_FRAME.size)
        except TimeoutError:
            sys.exit(f"frame {number}: found none after {TIMEOUT_S} s; {statistics()}")
        if received != frame:
            sys.exit(f"frame {number}: found {received.hex()}, expected {frame.hex()}; {statistics()}")
    adapter.ended.set()


if __name__ == "__main__":
    main()
