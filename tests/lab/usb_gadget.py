"""USB adapters that the kernel plugs into itself (dummy_hcd), with the vendor, product and serial number of real ones.

Kernel documentation: usb/gadget_configfs.rst, usb/functionfs.rst."""

import os
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

GADGETS = Path("/sys/kernel/config/usb_gadget")
TIMEOUT_S = 30


def run(*command):
    subprocess.run(command, check=True)


def wait_for(condition, what):
    deadline = time.monotonic() + TIMEOUT_S
    while not condition():
        if time.monotonic() > deadline:
            sys.exit(f"found no {what} after {TIMEOUT_S} s")
        time.sleep(0.05)


def load_modules():
    run("modprobe", "-a", "dummy_hcd", "libcomposite", "usb_f_acm", "usb_f_fs", "cdc-acm", "gs_usb")
    if not GADGETS.exists():
        run("mount", "-t", "configfs", "none", "/sys/kernel/config")


class Adapter:
    """Plugged in while the object is open. A derived class says what it does."""

    function = ""   # kind and name of the gadget's function
    devices = ""    # what the kernel makes of it, as a pattern

    def __init__(self, vendor, product, serial):
        self.folder = GADGETS / "adapter"
        self.is_pulled_out = False
        self.parts = ["", "strings/0x409", f"functions/{self.function}", "configs/c.1"]
        for part in self.parts:
            (self.folder / part).mkdir(parents=True, exist_ok=True)
        (self.folder / "idVendor").write_text(f"0x{vendor}")
        (self.folder / "idProduct").write_text(f"0x{product}")
        if serial:
            (self.folder / "strings/0x409/serialnumber").write_text(serial)
        (self.folder / "configs/c.1" / self.function).symlink_to(self.folder / "functions" / self.function)

    def device(self):
        """Folder of the device in /sys; None if there is none."""
        return next(Path("/sys/class").glob(self.devices), None)

    def prepare(self):
        """What must be done before it is plugged in."""

    def __enter__(self):
        self.prepare()
        (self.folder / "UDC").write_text("dummy_udc.0\n")
        wait_for(self.device, self.devices)
        run("udevadm", "settle", f"--timeout={TIMEOUT_S}")
        return self

    def __exit__(self, *_):
        self.is_pulled_out = True
        (self.folder / "UDC").write_text("\n")
        wait_for(lambda: not self.device(), f"end of {self.devices}")
        (self.folder / "configs/c.1" / self.function).unlink()
        self.clean_up()
        for part in reversed(self.parts):
            (self.folder / part).rmdir()
        run("udevadm", "settle", f"--timeout={TIMEOUT_S}")

    def clean_up(self):
        """What must be done after it was pulled out."""


class SerialAdapter(Adapter):
    """A serial line."""

    function = "acm.0"
    devices = "tty/ttyACM*"


class CanAdapter(Adapter):
    """A gs_usb adapter with one channel, which reports what it can do and carries no frames. The requests are those of
    Linux: drivers/net/can/usb/gs_usb.c."""

    function = "ffs.can"
    devices = "net/can*"
    FILES = Path("/dev/usb-can-adapter")
    EVENT = struct.Struct("<BBHHHB3x")
    SETUP = 4
    BT_CONST, DEVICE_CONFIG = 4, 5
    ANSWERS = {
        DEVICE_CONFIG: struct.pack("<4xII", 2, 1),  # one channel; versions of program and board
        # No special features, 48 MHz, and the limits of the bit timing of an STM32F072.
        BT_CONST: struct.pack("<10I", 0, 48_000_000, 1, 16, 1, 8, 4, 1, 1024, 1),
    }

    @staticmethod
    def descriptors(packet):
        interface = struct.pack("<9B", 9, 4, 0, 0, 2, 0xFF, 0xFF, 0xFF, 0)
        return interface + b"".join(struct.pack("<BBBBHB", 7, 5, address, 2, packet, 0) for address in (0x81, 0x02))

    def prepare(self):
        self.FILES.mkdir(exist_ok=True)
        run("mount", "-t", "functionfs", "can", self.FILES)
        self.control = os.open(self.FILES / "ep0", os.O_RDWR)
        body = struct.pack("<II", 3, 3) + self.descriptors(64) + self.descriptors(512)
        os.write(self.control, struct.pack("<III", 3, 12 + len(body), 3) + body)  # full and high speed
        os.write(self.control, struct.pack("<IIII", 2, 16, 0, 0))  # no strings
        threading.Thread(target=self.answer, daemon=True).start()

    def answer(self):
        try:
            # A read that begins after the kernel has disabled the function holds a lock for which pulling it out waits.
            while not self.is_pulled_out:
                kind, request, _, _, length, event = self.EVENT.unpack(os.read(self.control, self.EVENT.size))
                if event == self.SETUP and kind & 0x80:
                    os.write(self.control, self.ANSWERS.get(request, b"")[:length])
                elif event == self.SETUP:
                    os.read(self.control, length)
        except OSError:
            pass  # it was pulled out

    def clean_up(self):
        run("umount", "-l", self.FILES)
