"""An STM32F405 on a JTAG cable, for openocd's adapter remote_bitbang: the two TAPs of the chip (RM0090, section 38.5), the debug
port and the memory access port (ADIv5), the debug registers of the core (ARMv7-M, section C1), and the flash."""

from fake_stm32 import FLASH, SIZE, FlashRegisters, SocketChip

# The state after a clock with TMS 0, and with TMS 1 (IEEE 1149.1).
NEXT = {
    "reset": ("idle", "reset"), "idle": ("idle", "select DR"),
    "select DR": ("capture DR", "select IR"), "capture DR": ("shift DR", "exit DR"), "shift DR": ("shift DR", "exit DR"),
    "exit DR": ("pause DR", "update DR"), "pause DR": ("pause DR", "exit 2 DR"), "exit 2 DR": ("shift DR", "update DR"),
    "update DR": ("idle", "select DR"),
    "select IR": ("capture IR", "reset"), "capture IR": ("shift IR", "exit IR"), "shift IR": ("shift IR", "exit IR"),
    "exit IR": ("pause IR", "update IR"), "pause IR": ("pause IR", "exit 2 IR"), "exit 2 IR": ("shift IR", "update IR"),
    "update IR": ("idle", "select DR"),
}
DPACC, APACC, CORE_IDCODE = 0b1010, 0b1011, 0b1110
BOUNDARY_IDCODE = 0b00001
ACK = 0b010
RAM, RAM_SIZE = 0x20000000, 128 * 1024
CPUID, AIRCR, DFSR, DHCSR, DCRSR, DCRDR, DEMCR = (0xE000E000 + offset for offset in (
    0xD00, 0xD0C, 0xD30, 0xDF0, 0xDF4, 0xDF8, 0xDFC))


class Core:
    """Memory as the debugger reads and writes it. The core runs nothing."""

    def __init__(self, chip):
        self.chip, self.registers = chip, FlashRegisters(chip)
        self.ram = bytearray(RAM_SIZE)
        self.words = {CPUID: 0x410FC241, 0xE0002000: 0x260, 0xE0001000: 0x40000000,
                      0xE0042000: 0x10070000 | chip.device_id, 0x1FFF7A20: SIZE // 1024 << 16}
        self.is_halted = self.was_reset = False
        self.runs = 0  # how often the program was started

    def read(self, address, size):
        if FLASH <= address < FLASH + SIZE:
            return int.from_bytes(self.chip.read(address, size), "little")
        if RAM <= address < RAM + RAM_SIZE:
            return int.from_bytes(self.ram[address - RAM:address - RAM + size], "little")
        return self.word(address & ~3) >> 8 * (address & 3) & (1 << 8 * size) - 1

    def word(self, address):
        if address == DHCSR:
            value = self.words.get(DHCSR, 0) & 0xFFFF | 1 << 16 | self.is_halted << 17 | self.was_reset << 25
            self.was_reset = False
            return value
        if 0x40023C00 <= address < 0x40023C20:
            return self.registers.read(address)
        return self.words.get(address, 0)

    def write(self, address, size, value):
        content = value.to_bytes(size, "little")
        if FLASH <= address < FLASH + SIZE:
            self.registers.program(address, content)
        elif RAM <= address < RAM + RAM_SIZE:
            self.ram[address - RAM:address - RAM + size] = content
        elif 0x40023C00 <= address < 0x40023C20:
            self.registers.write(address, value)
        elif address == DHCSR:
            if value >> 16 == 0xA05F:
                self.words[DHCSR] = value & 0xFFFF
                self.halt(value & 3 == 3)
        elif address == AIRCR:
            if value & 4:
                self.registers.lock()
                self.was_reset = True
                self.halt(self.words.get(DEMCR, 0) & 1)
        elif address not in (CPUID, DCRSR, DFSR):
            self.words[address & ~3] = value

    def halt(self, is_halted):
        self.runs += self.is_halted and not is_halted
        self.is_halted = bool(is_halted)


class DebugPort:
    def __init__(self, core):
        self.core = core
        self.select = self.control = self.access = self.address = self.result = 0

    def transfer(self, is_access_port, request):
        """35 bits: read or write, the register, the data (ADIv5, section B3.4)."""
        is_read, register, data = request & 1, request >> 1 & 3, request >> 3
        if not is_access_port:
            if is_read:
                self.result = (0, self.control | (self.control & 0x50000000) << 1, self.select, self.result)[register]
            elif register == 1:
                self.control = data & 0x50000F00
            elif register == 2:
                self.select = data
            return
        register = self.select & 0xF0 | register << 2
        if self.select >> 24:
            self.result = 0
        elif is_read:
            self.result = self.read(register)
        else:
            self.write(register, data)

    def size(self):
        return 1 << (self.access & 7)

    def advance(self):
        """Within 4 KiB: Cortex-M4 technical reference manual, AHB-AP."""
        if self.access >> 4 & 3:
            self.address = self.address & ~0xFFF | self.address + self.size() & 0xFFF

    def read(self, register):
        if register == 0x0C:
            value = self.core.read(self.address, self.size()) << 8 * (self.address & 3)
            self.advance()
            return value
        if 0x10 <= register <= 0x1C:
            return self.core.read(self.address & ~0xF | register - 0x10, 4)
        return {0x00: self.access | 0x40, 0x04: self.address, 0xF8: 0xE00FF003, 0xFC: 0x24770011}.get(register, 0)

    def write(self, register, data):
        if register == 0x00:
            self.access = data
        elif register == 0x04:
            self.address = data
        elif register == 0x0C:
            self.core.write(self.address, self.size(), data >> 8 * (self.address & 3) & (1 << 8 * self.size()) - 1)
            self.advance()
        elif 0x10 <= register <= 0x1C:
            self.core.write(self.address & ~0xF | register - 0x10, 4, data)


class Cable:
    """The TAPs: first the core's, whose output the adapter reads, then that of the boundary scan."""

    def __init__(self, port):
        self.port = port
        self.state, self.core_ir, self.boundary_ir = "reset", CORE_IDCODE, BOUNDARY_IDCODE
        self.shifted = self.length = 0

    def capture(self):
        if self.state == "capture IR":
            self.shifted, self.length = 0b00001_0001, 9
            return
        value, bits = 0, 1
        if self.core_ir in (DPACC, APACC):
            value, bits = self.port.result << 3 | ACK, 35
        elif self.core_ir == CORE_IDCODE:
            value, bits = 0x4BA00477, 32
        boundary = (0x06413041, 32) if self.boundary_ir == BOUNDARY_IDCODE else (0, 1)
        self.shifted, self.length = value | boundary[0] << bits, bits + boundary[1]

    def update(self):
        if self.state == "update IR":
            self.core_ir, self.boundary_ir = self.shifted & 0xF, self.shifted >> 4
        elif self.core_ir in (DPACC, APACC):
            self.port.transfer(self.core_ir == APACC, self.shifted & (1 << 35) - 1)

    def clock(self, mode, data):
        if self.state in ("shift DR", "shift IR"):
            self.shifted = self.shifted >> 1 | data << self.length - 1
        elif self.state in ("capture DR", "capture IR"):
            self.capture()
        self.state = NEXT[self.state][mode]
        if self.state in ("update DR", "update IR"):
            self.update()
        elif self.state == "reset":
            self.core_ir, self.boundary_ir = CORE_IDCODE, BOUNDARY_IDCODE


class JtagChip(SocketChip):
    """openocd needs `script` as its interface."""

    def __init__(self, chip, folder):
        super().__init__(folder / "jtag.socket")
        self.core = Core(chip)
        # Without work area openocd programs word by word: no code runs in the chip.
        self.script = (f"adapter driver remote_bitbang\nremote_bitbang port 0\nremote_bitbang host {self.path}\n"
                       "transport select jtag\nset WORKAREASIZE 0\n")

    def answer_all(self, connection):
        cable, clock = Cable(DebugPort(self.core)), 0
        while True:
            received = connection.recv(65536)
            if not received:
                return
            output = bytearray()
            for character in received:
                if 0x30 <= character <= 0x37:  # "0" to "7": clock, mode, data
                    if character & 4 and not clock:
                        cable.clock(character >> 1 & 1, character & 1)
                    clock = character & 4
                elif character == 0x52:  # "R"
                    output.append(0x30 | cable.shifted & 1)
            if output:
                connection.sendall(output)
