"""What an STM32F405 does when it is flashed, after RM0090, section 3: its flash refuses what the real one refuses."""

import socket
import threading

FLASH = 0x08000000
SECTORS = [16 * 1024] * 4 + [64 * 1024] + [128 * 1024] * 7
SIZE = sum(SECTORS)
FACTORY_OPTIONS = 0x0FFFAAED  # FLASH_OPTCR of a chip as delivered (3.9.10)
START_ADDRESSES = [FLASH + sum(SECTORS[:number]) for number in range(len(SECTORS))]

KEYR, OPTKEYR, SR, CR, OPTCR = (0x40023C00 + offset for offset in (0x04, 0x08, 0x0C, 0x10, 0x14))
KEYS = [0x45670123, 0xCDEF89AB]
OPTION_KEYS = [0x08192A3B, 0x4C5D6E7F]
PROGRAM, SECTOR_ERASE, MASS_ERASE, START, LOCK = 1 << 0, 1 << 1, 1 << 2, 1 << 16, 1 << 31
PROTECTION_ERROR, SEQUENCE_ERROR = 1 << 4, 1 << 7


def sector_of(address):
    return max(number for number, start in enumerate(START_ADDRESSES) if start <= address)


class Stm32F405:
    """The flash with its option bytes. `events` has what was done to it: ("erase", sector), ("program", sector) once for
    each run of words, ("options", value)."""

    device_id = 0x413

    def __init__(self):
        self.flash = bytearray(b"\xff" * SIZE)
        self.options = FACTORY_OPTIONS & ~3
        self.events = []
        self.fails_at = None  # power is cut before this event

    # --- what the ROM bootloader and the registers do

    def record(self, event):
        if self.events[-1:] != [event] or event[0] != "program":
            if len(self.events) == self.fails_at:
                raise ConnectionAbortedError
            self.events.append(event)

    def is_protected(self, sector):
        return not self.options >> (16 + sector) & 1

    def erase(self, sector):
        """Whether it was allowed."""
        if self.is_protected(sector):
            return False
        self.record(("erase", sector))
        start = START_ADDRESSES[sector] - FLASH
        self.flash[start:start + SECTORS[sector]] = b"\xff" * SECTORS[sector]
        return True

    def program(self, address, content):
        """Whether it was allowed. Bits that are 0 stay 0."""
        sector = sector_of(address)
        if self.is_protected(sector):
            return False
        self.record(("program", sector))
        for offset, byte in enumerate(content, address - FLASH):
            self.flash[offset] &= byte
        return True

    def read(self, address, size):
        return bytes(self.flash[address - FLASH:address - FLASH + size])

    def set_options(self, value):
        self.record(("options", value & ~3))
        self.options = value & ~3

    # --- for tests

    def holds(self, address, content):
        return self.read(address, len(content)) == content

    def sector(self, number):
        return self.read(START_ADDRESSES[number], SECTORS[number])

    def fill(self, number, byte):
        start = START_ADDRESSES[number] - FLASH
        self.flash[start:start + SECTORS[number]] = bytes([byte]) * SECTORS[number]

    def sectors(self, kind):
        return [event[1] for event in self.events if event[0] == kind]


class FlashRegisters:
    """The registers of the flash (3.9)."""

    def __init__(self, chip):
        self.chip = chip
        self.lock()

    def lock(self):
        self.keys, self.option_keys = [], []
        self.status, self.control, self.locks_options = 0, LOCK, True
        self.pending_options = self.chip.options

    def read(self, address):
        return {SR: self.status, CR: self.control,
                OPTCR: self.pending_options & ~3 | self.locks_options}.get(address, 0)

    def write(self, address, value):
        if address == KEYR:
            self.keys = (self.keys + [value])[-2:]
            if self.keys == KEYS:
                self.control &= ~LOCK
        elif address == OPTKEYR:
            self.option_keys = (self.option_keys + [value])[-2:]
            if self.option_keys == OPTION_KEYS:
                self.locks_options = False
        elif address == SR:
            self.status &= ~value
        elif address == CR and not self.control & LOCK:
            self.control = value & ~START
            if value & START and value & MASS_ERASE:
                self.chip.record(("mass erase",))
            elif value & START and value & SECTOR_ERASE and not self.chip.erase(value >> 3 & 0xF):
                self.status |= PROTECTION_ERROR
        elif address == OPTCR and not self.locks_options:
            self.pending_options = value & ~3
            if value & 2:
                self.chip.set_options(self.pending_options)
            self.locks_options = bool(value & 1)

    def program(self, address, content):
        if self.control & LOCK or not self.control & PROGRAM:
            self.status |= SEQUENCE_ERROR
        elif not self.chip.program(address, content):
            self.status |= PROTECTION_ERROR


class SocketChip:
    """A chip behind a socket of the file system, until the end of a `with`. `answer_all(connection)` of the derived class
    serves one connection until the other side closes it."""

    def __init__(self, path):
        self.path = path

    def __enter__(self):
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(self.path))
        self.listener.listen()
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.thread.join()
        self.listener.close()
        self.path.unlink()

    def serve(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            with connection:
                try:
                    self.answer_all(connection)
                except ConnectionError:
                    pass
