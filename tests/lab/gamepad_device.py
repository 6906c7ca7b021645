"""Gamepads that the kernel plugs into itself (uinput). Kernel documentation: input/uinput.rst."""

import fcntl
import os
import struct

EV_SYN, EV_KEY, EV_ABS = 0, 1, 3
ABS_X, ABS_Y = 0, 1
BTN_SOUTH, BTN_EAST = 0x130, 0x131
STICK_MAX = 32767

UI_DEV_CREATE, UI_DEV_DESTROY = 0x5501, 0x5502
UI_DEV_SETUP, UI_ABS_SETUP = 0x405C5503, 0x401C5504
UI_SET_EVBIT, UI_SET_KEYBIT, UI_SET_ABSBIT = 0x40045564, 0x40045565, 0x40045567
BUS_USB = 3


class Gamepad:
    """Two axes and two buttons. Plugged in while the object is open."""

    def __init__(self, name="Lab pad", keys=(BTN_SOUTH, BTN_EAST), axes=(ABS_X, ABS_Y)):
        self.file = os.open("/dev/uinput", os.O_WRONLY)
        fcntl.ioctl(self.file, UI_SET_EVBIT, EV_KEY)
        for key in keys:
            fcntl.ioctl(self.file, UI_SET_KEYBIT, key)
        fcntl.ioctl(self.file, UI_SET_EVBIT, EV_ABS)
        for axis in axes:
            fcntl.ioctl(self.file, UI_SET_ABSBIT, axis)
            fcntl.ioctl(self.file, UI_ABS_SETUP, struct.pack("<HHiiiiii", axis, 0, 0, -STICK_MAX - 1, STICK_MAX, 0, 0, 0))
        fcntl.ioctl(self.file, UI_DEV_SETUP, struct.pack("<HHHH80sI", BUS_USB, 0x1234, 0x5678, 1, name.encode(), 0))
        fcntl.ioctl(self.file, UI_DEV_CREATE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.unplug()

    def unplug(self):
        if self.file is not None:
            fcntl.ioctl(self.file, UI_DEV_DESTROY)
            os.close(self.file)
            self.file = None

    def write(self, *events):
        """Events (type, code, value), as one report."""
        for kind, code, value in (*events, (EV_SYN, 0, 0)):
            os.write(self.file, struct.pack("<qqHHi", 0, 0, kind, code, value))

    def stick(self, axis, position):
        """-1 to 1."""
        self.write((EV_ABS, axis, round(position * STICK_MAX)))

    def button(self, key, is_pressed):
        self.write((EV_KEY, key, int(is_pressed)))
