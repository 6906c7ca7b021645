"""The bootloader and the image that are flashed run in QEMU's STM32F405, and receive what a module received in a run with virtual chips. They
must send the same frames. QEMU's CPU and interrupt controller are not those of the virtual chip, and peripherals.py is written from the
manual alone.

    replay_test.py PROLEG SCENARIO FOLDER_OF_IMAGES QEMU OBJDUMP
"""

import re
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import machine as machines  # noqa: E402

PROLEG, SCENARIO, IMAGES, QEMU, OBJDUMP = sys.argv[1:6]
NODE = 3
SECONDS = 1
FLASH_BASE, BOARD_RECORDS, SLOT_A, SECTOR_SIZE = 0x08000000, 0x08008000, 0x08020000, 128 * 1024
CONFIRMED = 0x600D600D
BOOT_UP, STATE, MONITORING, TPDO = 0x700 + NODE, 0x180 + NODE, 0x380 + NODE, 0x580 + NODE
OWN = {BOOT_UP, STATE, MONITORING, TPDO, 0x80 + NODE}
SYNC = 0x080
SERIAL_ANSWER = bytes.fromhex("43181004")  # of an SDO: object 0x1018:4
BOOT_UP_US = 62  # time of a frame with 1 byte
FRAMES_OF_TWO_TICKS = 60  # at least


def read_log(path):
    """Frames as (microseconds, identifier, data)."""
    frames = []
    for line in path.read_text().splitlines():
        seconds, identifier, data = re.fullmatch(r"\((\d+\.\d+)\) \S+ ([0-9A-F]{3})#([0-9A-F]*)", line).groups()
        frames.append((round(float(seconds) * 1e6), int(identifier, 16), bytes.fromhex(data)))
    return frames


def unique_id_of(serial):
    """Three words whose CRC-32 is this serial number: the last word is found bit by bit, because a CRC is linear."""
    start = zlib.crc32(bytes(12))
    rows = [(zlib.crc32(bytes(8) + (1 << bit).to_bytes(4, "little")) ^ start, 1 << bit) for bit in range(32)]
    wanted, word = serial ^ start, 0
    for bit in reversed(range(32)):
        pivot = next((row for row in rows if row[0] >> bit & 1), None)
        if pivot is None:
            continue
        rows = [(row[0] ^ pivot[0], row[1] ^ pivot[1]) if row[0] >> bit & 1 else row for row in rows if row is not pivot]
        if wanted >> bit & 1:
            wanted, word = wanted ^ pivot[0], word ^ pivot[1]
    return [0, 0, word]


def flash_of_module(folder):
    """The bootloader, a board record and a confirmed image, as docs/flashing.md describes them."""
    record = folder / "record.bin"
    script = Path(__file__).resolve().parents[4] / "firmware/stm32f405/make_board_record.py"
    subprocess.run([sys.executable, script, "--node", str(NODE), "--feedback", "1000", "3000", record], check=True)
    flash = bytearray(b"\xff" * (1 << 20))
    for address, content in ((FLASH_BASE, (Path(IMAGES) / "proleg_boot_stm32f405.bin").read_bytes()), (BOARD_RECORDS, record.read_bytes()),
                             (SLOT_A, (Path(IMAGES) / "proleg_stm32f405.pimg").read_bytes()),
                             (SLOT_A + SECTOR_SIZE - 16, CONFIRMED.to_bytes(4, "little"))):
        flash[address - FLASH_BASE:address - FLASH_BASE + len(content)] = content
    return bytes(flash)


def handlers_of_faults(flash):
    """Addresses of HardFault, MemManage, BusFault and UsageFault in the vector tables of the bootloader and of the image."""
    found = []
    for table in (0, SLOT_A - FLASH_BASE + 512):
        found += [int.from_bytes(flash[table + 4 * i:table + 4 * i + 4], "little") & ~1 for i in range(3, 7)]
    return found


def comparable(frame):
    """A frame without what the sensors measure, of which QEMU has none: the contents of monitoring."""
    identifier, data = frame
    return identifier, bytes(len(data)) if identifier == MONITORING else data


class Replay:
    """What the module sends when it receives the frames of a log. Its own frames leave their mailboxes when they did in the log: which frame
    wins the bus depends on those of the others."""

    def __init__(self, machine, log):
        self.machine = machine
        self.peripherals = machine.peripherals
        self.log = log

    def run(self):
        """The module's frames: those that it has sent, and those that it still has to send."""
        sent = []
        can = self.peripherals.can
        self.start(next(time for time, identifier, _ in self.log if identifier in OWN))
        for position, (time, identifier, data) in enumerate(self.log):
            if time < self.peripherals.now:
                continue  # the module is not yet on the bus
            self.advance(time)
            if identifier in OWN:
                if identifier in can.pending():
                    sent.append(can.complete(identifier))
                    self.wake()
            elif can.accepts(identifier):
                if identifier == SYNC:
                    self.set_contacts(position)
                can.received.append((identifier, data))
                self.wake()
        return sent + list(can.pending().values())

    def start(self, boot_up):
        """Sets the time so that the boot-up message, for which the module waits, ends when it did in the log."""
        passed = boot_up - BOOT_UP_US - self.peripherals.alarm()
        self.peripherals.timer_5_starts += passed
        self.peripherals.now += passed

    def wake(self):
        self.machine.emulator.raise_interrupt(self.peripherals.interrupts()[0])
        self.settle()

    def settle(self):
        if not self.machine.run_to_sleep():
            raise machines.EmulatorError("a load of the system memory was found too late")

    def advance(self, time):
        """Lets the time pass to this one, with all alarms before it."""
        while (alarm := self.peripherals.alarm()) is not None and alarm < time:
            self.peripherals.now = alarm
            self.machine.alarm_rings()
            self.settle()
        self.peripherals.now = time

    def set_contacts(self, position):
        """Sets the touch switches of the link behind the joint so that the state frames have the contacts of the log. A contact changes with
        its second equal sample, so the switches are a tick ahead."""
        states = [data for _, identifier, data in self.log[position:position + FRAMES_OF_TWO_TICKS] if identifier == STATE]
        self.peripherals.contacts = 15 & ~(states[1][6] & 3 if len(states) > 1 else 0)


class QemuReplay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        folder = Path(cls.folder.name)
        path = folder / "bus.log"
        subprocess.run([PROLEG, "hil", SCENARIO, "--modules", "mcu", "--seconds", str(SECONDS), "--can-log", path, "--json"], check=True,
                       stdout=subprocess.DEVNULL)
        log = read_log(path)
        last_sync = max(position for position, frame in enumerate(log) if frame[1] == SYNC)
        cls.log = log[:last_sync]  # the answers to the last one are not in the log
        cls.code = {}
        for name in ("proleg_boot_stm32f405.elf", "proleg_stm32f405.elf"):
            cls.code |= machines.disassemble(OBJDUMP, Path(IMAGES) / name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def replay(self, log):
        """Frames that the module sends, and the machine."""
        folder = Path(self.folder.name)
        flash = flash_of_module(folder)
        serial = next(int.from_bytes(data[4:], "little") for _, identifier, data in self.log
                      if identifier == TPDO and data[:4] == SERIAL_ANSWER)
        words = unique_id_of(serial)
        system_memory = {0x1FFF7A10 + 4 * i: word for i, word in enumerate(words)} | {0x1FFF7A2C: 1200 << 16 | 940}
        machine = machines.start(QEMU, folder, flash, self.code, system_memory, handlers_of_faults(flash))
        with machine.emulator:
            return [comparable(frame) for frame in Replay(machine, log).run()], machine

    def expected(self):
        return [comparable(frame[1:]) for frame in self.log if frame[1] in OWN]

    def test_module_sends_the_frames_of_the_virtual_chip(self):
        sent, machine = self.replay(self.log)
        console = machine.peripherals.console
        print(f"{len(sent)} frames of node {NODE}, {machine.accesses} accesses to peripherals; console: {console.strip()}", file=sys.stderr)
        self.assertIn(f"proleg module, node {NODE}, board 1", console)
        self.assertIn("started by power on", console)
        self.assertGreaterEqual(len([frame for frame in sent if frame[0] == STATE]), 100 * SECONDS)
        self.assertEqual(sent, self.expected())

    def test_a_tick_that_is_missing_in_the_log_is_found(self):
        syncs = [position for position, frame in enumerate(self.log) if frame[1] == SYNC]
        removed = syncs[len(syncs) // 8]
        sent, _ = self.replay(self.log[:removed] + self.log[removed + 1:syncs[len(syncs) // 4]])
        self.assertIn(STATE, {frame[0] for frame in sent})
        self.assertNotEqual(sent, self.expected()[:len(sent)])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[6:]])
