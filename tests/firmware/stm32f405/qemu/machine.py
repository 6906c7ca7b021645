"""The program of a module in QEMU: its accesses to peripherals are answered by peripherals.py, and time passes only while it sleeps."""

import re
import subprocess

from emulator import Emulator, EmulatorError
from peripherals import IRQ_TIM5, Peripherals

SP, LR, PC = 13, 14, 15
REGISTER = {**{f"r{i}": i for i in range(13)}, "sl": 10, "fp": 11, "ip": 12, "sp": SP, "lr": LR, "pc": PC}
MAX_ACCESSES = 1_000_000
SLOT_A = 0x08020000  # the program; the bootloader is below
RESET_VECTOR = 0x08000004


class Instruction:
    def __init__(self, address, size, text):
        self.address = address
        self.size = size
        self.text = text
        self.mnemonic, _, operands = text.partition("\t")
        self.operands = operands.split("@")[0].split(";")[0].strip()

    @property
    def is_load(self):
        return self.mnemonic.startswith("ld")

    def registers(self):
        """Registers that it loads or stores, in the order of the addresses."""
        braces = re.search(r"\{(.*)\}", self.operands)
        names = braces.group(1) if braces else self.operands.split("[")[0]
        return [REGISTER[name.strip()] for name in names.split(",") if name.strip()]

    def load_address(self, values):
        """The address of a load of the form [register] or [register, #offset]; None for another form."""
        found = re.fullmatch(r".*\[(\w+)(?:, #(-?\d+))?\]", self.operands)
        return values[REGISTER[found.group(1)]] + int(found.group(2) or 0) if found else None


def disassemble(objdump, file):
    """The instructions of an ELF file by address."""
    listing = subprocess.run([objdump, "-d", str(file)], capture_output=True, text=True, check=True).stdout
    found = {}
    for line in listing.splitlines():
        match = re.match(r"\s*([0-9a-f]+):\t((?:[0-9a-f]{4} ?)+)\s*\t(.*)", line)
        if match:
            code = match.group(2).replace(" ", "")
            found[int(match.group(1), 16)] = Instruction(int(match.group(1), 16), len(code) // 2, match.group(3))
    return found


class Machine:
    """A chip that runs from its reset. code: Instruction by address. system_memory: words by address. faults: addresses of the handlers of
    faults. loads: addresses of the instructions that read the system memory, which QEMU does not have; the set grows."""

    def __init__(self, emulator, code, system_memory, faults, loads):
        self.emulator = emulator
        self.code = code
        self.system_memory = system_memory
        self.faults = faults
        self.loads = loads
        self.peripherals = Peripherals()
        self.accesses = 0
        self.sleeps_at = None
        self.reset_handler = emulator.read(RESET_VECTOR) & ~1
        self.sleeps = {address for address, instruction in code.items() if instruction.mnemonic == "wfi"}
        for address in self.sleeps | set(faults) | loads:
            emulator.break_at(address)
        for address in self.peripherals.addresses():
            emulator.watch(address)

    def run_to_sleep(self):
        """Runs until the program sleeps without a request that would wake it. False: a load of the system memory was found, and the chip
        must start again."""
        while True:
            stop = self.emulator.go()
            values = self.emulator.registers()
            at = values[PC]
            if stop.accessed is not None:
                self.answer(stop.accessed, values)
            elif at in self.sleeps:
                self.emulator.set_register(PC, at + self.code[at].size)
                requests = self.peripherals.interrupts()
                if not requests:
                    self.sleeps_at = at
                    return True
                self.emulator.raise_interrupt(requests[0])
            elif at in self.loads:
                self.load(self.code[at], values)
            elif at in self.faults:
                return self.learn(values)
            elif at == self.reset_handler:  # after a reset by software QEMU stands still
                self.peripherals.reset()
            else:
                raise EmulatorError(f"QEMU stopped with '{stop.text}' at {at:#x}")

    def answer(self, address, values):
        """Does an instruction that would access a word, and perhaps those after it."""
        self.accesses += 1
        if self.accesses > MAX_ACCESSES:
            raise EmulatorError(f"the program does not sleep: it accesses {address:#x} at {values[PC]:#x}")
        instruction = self.code[values[PC]]
        for number, register in enumerate(instruction.registers()):
            if instruction.is_load:
                self.emulator.set_register(register, self.peripherals.read(address + 4 * number))
            else:
                self.peripherals.write(address + 4 * number, values[register])
        self.emulator.set_register(PC, instruction.address + instruction.size)

    def load(self, instruction, values):
        address = instruction.load_address(values)
        for number, register in enumerate(instruction.registers()):
            self.emulator.set_register(register, self.system_memory[address + 4 * number])
        self.emulator.set_register(PC, instruction.address + instruction.size)

    def learn(self, values):
        """A fault: the load of system memory that caused it is done from outside the next time."""
        at = self.emulator.read(values[SP] + 24)  # the program counter in the frame of the exception
        status, bus_address = self.emulator.read(0xE000ED28), self.emulator.read(0xE000ED38)  # CFSR, BFAR
        if at in self.loads or bus_address not in self.system_memory:
            raise EmulatorError(f"the program has a fault at {at:#x}: CFSR {status:#x}, BFAR {bus_address:#x}")
        self.loads.add(at)
        return False

    def alarm_rings(self):
        self.emulator.raise_interrupt(IRQ_TIM5)


def start(program, folder, flash, code, system_memory, faults):
    """A machine whose program sleeps for the first time. Before that, the bootloader sleeps while it listens after power on."""
    loads = set()
    while True:
        emulator = Emulator(program, folder, flash)
        try:
            machine = Machine(emulator, code, system_memory, faults, loads)
            while machine.run_to_sleep():
                if machine.sleeps_at >= SLOT_A:
                    return machine
                machine.peripherals.now = machine.peripherals.alarm()
                machine.alarm_rings()
        except BaseException:
            emulator.close()
            raise
        emulator.close()
