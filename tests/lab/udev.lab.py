#!/usr/bin/python3
"""The shipped udev rules: an adapter that is plugged in has its stable name and its rights.

The adapters are USB devices that the kernel makes itself (dummy_hcd), with the numbers of real ones; udevd reads the rules
as it does on a user's computer."""

import grp
import json
import os
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, os.environ["PROLEG_LAB_CHECKS"])
from usb_gadget import CanAdapter, SerialAdapter, load_modules, wait_for  # noqa: E402

RULES = Path(os.environ["PROLEG_LAB_CHECKS"]).parents[1] / "host" / "udev" / "70-proleg.rules"


def expect(found, expected, what):
    if found != expected:
        sys.exit(f"{what}: found {found}, expected {expected}")


def properties(device):
    query = subprocess.run(["udevadm", "info", "--query=property", device], capture_output=True, text=True, check=True)
    return dict(line.split("=", 1) for line in query.stdout.splitlines())


def names():
    folder = Path("/dev/proleg")
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def group_of(path):
    return grp.getgrgid(os.stat(path).st_gid).gr_name


def usb_file(vendor, product):
    """Device file of a USB device."""
    for device in Path("/sys/bus/usb/devices").glob("*-*"):
        numbers = [(device / name).read_text().strip() for name in ("idVendor", "idProduct") if (device / name).exists()]
        if numbers == [vendor, product]:
            bus, number = (int((device / name).read_text()) for name in ("busnum", "devnum"))
            return f"/dev/bus/usb/{bus:03}/{number:03}"
    sys.exit(f"found no USB device {vendor}:{product}")


def check_serial_lines():
    with SerialAdapter("16d0", "117e", "205A3283"):
        line = Path("/dev/proleg/serial-205A3283-if00")
        expect(names(), [line.name], "names of a CANable")
        expect(group_of(line), "dialout", "group of a CANable")
        expect(oct(line.stat().st_mode & 0o777), "0o660", "rights of a CANable")
        expect(properties(line).get("ID_MM_PORT_IGNORE"), "1", "ID_MM_PORT_IGNORE of a CANable")
        expect("uaccess" in properties(line).get("TAGS", ""), True, "tag uaccess of a CANable")
    expect(names(), [], "names without an adapter")

    with SerialAdapter("1a86", "7523", ""):
        expect([name.startswith("port-") for name in names()], [True], f"names of a CH340, {names()}")

    with SerialAdapter("0483", "374b", "066DFF"):
        expect(names(), ["serial-066DFF-if00"], "names of an ST-Link")
        expect(group_of(usb_file("0483", "374b")), "plugdev", "group of an ST-Link")

    with SerialAdapter("0483", "df11", "2062344E"):
        expect(names(), [], "names of an STM32 in its ROM bootloader")
        expect(group_of(usb_file("0483", "df11")), "plugdev", "group of an STM32 in its ROM bootloader")

    with SerialAdapter("1234", "5678", "1"):
        expect(names(), [], "names of a device that is no adapter")


def check_can_interface():
    with CanAdapter("1d50", "606f", "0031002F4B465315") as adapter:
        link = subprocess.run(["ip", "-json", "link", "show", "dev", "can0031002F4B_0"], capture_output=True, text=True,
                              check=False)
        expect(link.stderr, "", "interface with the second name")
        expect(json.loads(link.stdout)[0]["ifname"], adapter.device().name, "its first name")
        expect(json.loads(link.stdout)[0]["txqlen"], 128, "its queue")
        expect(group_of(usb_file("1d50", "606f")), "plugdev", "group of a candleLight")


def main():
    os.makedirs("/run/udev/rules.d", exist_ok=True)
    Path("/run/udev/rules.d", RULES.name).write_text(RULES.read_text())
    with open("udevd.log", "w+", encoding="utf-8") as log:
        subprocess.Popen(["/lib/systemd/systemd-udevd"], stdout=log, stderr=log)
        wait_for(lambda: Path("/run/udev/control").exists(), "udevd")
        load_modules()
        check_can_interface()
        check_serial_lines()
        log.seek(0)
        expect([line for line in log if RULES.name in line], [], "what udevd says about the rules")


if __name__ == "__main__":
    main()
