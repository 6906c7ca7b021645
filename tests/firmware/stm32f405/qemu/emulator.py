"""QEMU's machine netduinoplus2, an STM32F405, from outside: registers and break points by gdb's remote protocol (gdb's manual, appendix E),
the interrupt controller by QEMU's own test protocol."""

import socket
import subprocess
import time

FIRST_REPLY_S = 30
REPLY_S = 300


class EmulatorError(Exception):
    """QEMU has ended, or answers what nothing here expects."""


def _connect(process, path):
    connection = socket.socket(socket.AF_UNIX)
    for _ in range(FIRST_REPLY_S * 20):
        try:
            connection.connect(str(path))
            connection.settimeout(REPLY_S)
            return connection
        except OSError:
            if process.poll() is not None:
                break
            time.sleep(0.05)
    raise EmulatorError(f"QEMU takes no connection at {path}")


class Stop:
    """Why the chip stands still: a break point, or an access to a watched word, which has been done."""

    def __init__(self, text):
        self.text = text
        self.accessed = None
        for part in text[3:].split(";"):
            if part.startswith("awatch:"):
                self.accessed = int(part.removeprefix("awatch:"), 16)


class Emulator:
    """A chip with these bytes in its flash, which stands still at its reset. folder: for the sockets."""

    def __init__(self, program, folder, flash):
        image = folder / "flash.bin"
        image.write_bytes(flash)
        paths = [folder / "gdb", folder / "qtest"]
        for path in paths:
            path.unlink(missing_ok=True)
        gdb, qtest = (f"unix:{path},server=on,wait=off" for path in paths)
        self.process = subprocess.Popen(
            [program, "-M", "netduinoplus2", "-accel", "tcg", "-display", "none", "-monitor", "none", "-serial", "none", "-S",
             "-gdb", gdb, "-qtest", qtest, "-qtest-log", "/dev/null", "-kernel", str(image)])
        self.debugger = self.qtest = self.bus = None
        try:
            self.debugger = _connect(self.process, paths[0])
            self.qtest = _connect(self.process, paths[1])
            self.bus = self.qtest.makefile("rw")
            # QEMU reads and writes single registers only for a debugger that has asked for their description.
            self.command("qXfer:features:read:target.xml:0,ffb")
        except Exception:
            self.close()
            raise

    def close(self):
        for connection in (self.bus, self.qtest, self.debugger):
            if connection is not None:
                connection.close()
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def command(self, text):
        self.debugger.sendall(f"${text}#{sum(text.encode()) & 0xFF:02x}".encode())
        received = b""
        while not (b"$" in received and received[-3:-2] == b"#"):
            part = self.debugger.recv(65536)
            if not part:
                raise EmulatorError(f"QEMU has ended after the command '{text}'")
            received += part
        self.debugger.sendall(b"+")
        return received[received.index(b"$") + 1:-3].decode()

    def expect_ok(self, text):
        reply = self.command(text)
        if reply != "OK":
            raise EmulatorError(f"QEMU answers '{reply}' to '{text}'")

    def go(self):
        return Stop(self.command("c"))

    def registers(self):
        """r0 to r12, sp, lr, pc."""
        data = bytes.fromhex(self.command("g")[:128])
        return [int.from_bytes(data[4 * i:4 * i + 4], "little") for i in range(16)]

    def set_register(self, number, value):
        self.expect_ok(f"P{number:x}={value.to_bytes(4, 'little').hex()}")

    def break_at(self, address):
        self.expect_ok(f"Z1,{address:x},2")

    def watch(self, address):
        self.expect_ok(f"Z4,{address:x},4")

    def _test_command(self, text):
        self.bus.write(text + "\n")
        self.bus.flush()
        reply = self.bus.readline().split()
        if not reply or reply[0] != "OK":
            raise EmulatorError(f"QEMU answers '{' '.join(reply)}' to '{text}'")
        return reply

    def read(self, address):
        return int(self._test_command(f"readl {address:#x}")[1], 16)

    def write(self, address, value):
        self._test_command(f"writel {address:#x} {value:#x}")

    def raise_interrupt(self, number):
        interrupt_set_pending = 0xE000E200  # NVIC_ISPR0 (ARMv7-M, B3.4.5)
        self.write(interrupt_set_pending + 4 * (number // 32), 1 << number % 32)
