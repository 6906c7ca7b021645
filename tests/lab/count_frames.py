#!/usr/bin/python3
"""count_frames.py CHANNEL FILE: counts the frames that python-can receives by slcan, until the line is closed. FILE gets the
line 0 when the channel is open, and the number at the end."""

import os
import select
import sys

import can


class LargeReads:
    """The serial port of python-can, read in parts of any size. With the single bytes for which python-can asks, two
    programs take all time of an emulated processor."""

    def __init__(self, port):
        self.port = port
        self.timeout = None

    @property
    def in_waiting(self):
        return bool(select.select([self.port.fileno()], [], [], 0)[0])

    def read(self):
        if not select.select([self.port.fileno()], [], [], self.timeout)[0]:
            return b""
        part = os.read(self.port.fileno(), 1 << 16)
        if not part:
            raise EOFError
        return part

    def __getattr__(self, name):
        return getattr(self.port, name)


channel, name = sys.argv[1:]
with open(name, "w", encoding="ascii", buffering=1) as file:
    bus = can.Bus(interface="slcan", channel=channel, bitrate=1000000, sleep_after_open=0.2)
    bus.serialPortOrig = LargeReads(bus.serialPortOrig)
    count = 0
    print(count, file=file)
    try:
        while True:
            count += bus.recv(60) is not None
    except (can.CanError, OSError, EOFError):
        pass  # the robot has been switched off
    print(count, file=file)
