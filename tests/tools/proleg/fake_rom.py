"""The ROM bootloader of an STM32F405: over a UART (AN3155) on a pseudo terminal, and over USB (AN3156, DFU 1.1) behind
fake_libusb.cpp."""

import errno
import os
import pty
import struct
import threading
import tty

from fake_stm32 import FLASH, SIZE, SocketChip, sector_of

ACK, NACK = b"\x79", b"\x1f"
GET, VERSION, DEVICE_ID, READ, GO, WRITE, ERASE = 0x00, 0x01, 0x02, 0x11, 0x21, 0x31, 0x44
OTHERS = bytes([0x63, 0x73, 0x82, 0x92])  # write and read protection, on and off
ALL_SECTORS = 0xFFFF


def checksum(content):
    value = 0
    for byte in content:
        value ^= byte
    return value


class UartRom:
    """Behind a pseudo terminal, until the end of a `with`."""

    def __init__(self, chip):
        self.chip = chip
        self.commands = []  # all that it has got

    def __enter__(self):
        self.terminal, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()
        return self

    def __exit__(self, *_):
        # The end of the last program that has the terminal open ends the thread.
        os.close(self.slave)
        self.thread.join()
        os.close(self.terminal)

    def receive(self, size):
        content = b""
        while len(content) < size:
            try:
                received = os.read(self.terminal, size - len(content))
            except OSError as error:
                if error.errno != errno.EIO:
                    raise
                received = b""
            if not received:
                raise EOFError
            content += received
        return content

    def send(self, content):
        os.write(self.terminal, content)

    def serve(self):
        try:
            while self.receive(1) != b"\x7f":
                pass
            self.send(ACK)
            while True:
                command, complement = self.receive(2)
                if command ^ complement != 0xFF:
                    self.send(NACK)
                    continue
                self.commands.append(command)
                self.execute(command)
        except (EOFError, ConnectionAbortedError):
            pass

    def execute(self, command):
        is_open = self.chip.options >> 8 & 0xFF == 0xAA
        if command == GET:
            known = bytes([0x31, GET, VERSION, DEVICE_ID, READ, GO, WRITE, ERASE]) + OTHERS
            self.send(ACK + bytes([len(known) - 1]) + known + ACK)
        elif command == VERSION:
            self.send(ACK + b"\x31\x00\x00" + ACK)
        elif command == DEVICE_ID:
            self.send(ACK + struct.pack(">BH", 1, self.chip.device_id) + ACK)
        elif command in (READ, WRITE, ERASE) and is_open:
            self.send(ACK)
            {READ: self.read, WRITE: self.write, ERASE: self.erase}[command]()
        else:
            self.send(NACK)

    def address(self):
        """Nothing if it is no address of the flash."""
        word = self.receive(5)
        address, = struct.unpack(">I", word[:4])
        is_right = checksum(word) == 0 and FLASH <= address < FLASH + SIZE
        self.send(ACK if is_right else NACK)
        return address if is_right else None

    def read(self):
        address = self.address()
        if address is None:
            return
        length, complement = self.receive(2)
        is_right = length ^ complement == 0xFF
        self.send(ACK + self.chip.read(address, length + 1) if is_right else NACK)

    def write(self):
        address = self.address()
        if address is None:
            return
        length = self.receive(1)
        content = self.receive(length[0] + 2)
        if checksum(length + content) != 0 or len(content) % 4 != 1:
            self.send(NACK)
            return
        self.chip.program(address, content[:-1])  # a protected sector is no error (AN3155)
        self.send(ACK)

    def erase(self):
        head = self.receive(2)
        count, = struct.unpack(">H", head)
        if count == ALL_SECTORS:
            self.receive(1)
            self.chip.record(("mass erase",))
            self.send(ACK)
            return
        rest = self.receive(2 * (count + 1) + 1)
        if checksum(head + rest) != 0:
            self.send(NACK)
            return
        for sector in struct.unpack(f">{count + 1}H", rest[:-1]):
            self.chip.erase(sector)
        self.send(ACK)


# AN3156; DFU 1.1, sections 3 and 6.1.2; USB 2.0, section 9.4.
DOWNLOAD, UPLOAD, GET_STATUS, CLEAR_STATUS, GET_STATE, ABORT = 1, 2, 3, 4, 5, 6
CLASS = 0x20  # bit of the type of a request; the others are of USB itself
SET_INTERFACE, GET_DESCRIPTOR = 0x0B, 0x06
IDLE, DOWNLOAD_SYNC, BUSY, DOWNLOAD_IDLE, UPLOAD_IDLE, ERROR = 2, 3, 4, 5, 9, 10
OK, ERROR_VENDOR, ERROR_WRITE, ERROR_ADDRESS = 0, 11, 3, 8
STALL = -9  # LIBUSB_ERROR_PIPE
TRANSFER_SIZE = 2048
# What the chip says of itself.
STRINGS = {4: "@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg", 5: "@Option Bytes  /0x1FFFC000/01*016 e",
           6: "@OTP Memory /0x1FFF7800/01*512 e,01*016 e", 7: "@Device Feature/0xFFFF0000/01*004 e"}


class DfuRom(SocketChip):
    def __init__(self, chip, folder):
        super().__init__(folder / "dfu.socket")
        self.chip = chip
        self.state, self.status, self.pointer, self.pending = IDLE, OK, FLASH, None
        self.alternates = []  # all that were chosen

    def answer_all(self, connection):
        with connection.makefile("rb") as stream:
            while setup := stream.read(8):
                kind, request, value, _, length = struct.unpack("<BBHHH", setup)
                content = b"" if kind & 0x80 else stream.read(length)
                answer = (self.answer(request, value, length, content) if kind & CLASS
                          else self.answer_standard(request, value))
                if isinstance(answer, bytes):
                    answer = answer[:length]
                    connection.sendall(struct.pack("<i", len(answer)) + answer)
                else:
                    connection.sendall(struct.pack("<i", answer))

    def is_open(self):
        """No read protection."""
        return self.chip.options >> 8 & 0xFF == 0xAA

    def fail(self, status):
        self.state, self.status = ERROR, status
        return STALL

    def answer_standard(self, request, value):
        if request == SET_INTERFACE:
            self.alternates.append(value)
            return 0
        assert request == GET_DESCRIPTOR
        text = STRINGS[value & 0xFF].encode("utf-16-le") if value & 0xFF else b"\x09\x04"  # the language: English
        return bytes([len(text) + 2, 3]) + text

    def answer(self, request, value, length, content):
        """Bytes for the host, or the number of bytes that were taken, or an error."""
        if request == GET_STATUS:
            return self.report()
        if request == GET_STATE:
            return bytes([self.state])
        if request in (ABORT, CLEAR_STATUS):
            self.state, self.status = IDLE, OK
            return 0
        if request == DOWNLOAD and self.state in (IDLE, DOWNLOAD_IDLE):
            self.pending, self.state = (value, content), DOWNLOAD_SYNC
            return len(content)
        if request == UPLOAD and self.is_open() and self.state in (IDLE, UPLOAD_IDLE) and value >= 2:
            self.state = UPLOAD_IDLE
            return self.chip.read(self.pointer + (value - 2) * TRANSFER_SIZE, length)
        return self.fail(ERROR_VENDOR)

    def report(self):
        """A download takes effect when its status is read; it is done at the next time."""
        if self.state == DOWNLOAD_SYNC and not self.is_open():
            self.fail(ERROR_VENDOR)
        elif self.state == DOWNLOAD_SYNC:
            self.state = BUSY
            self.download(*self.pending)
        elif self.state == BUSY:
            self.state = DOWNLOAD_IDLE if self.status == OK else ERROR
        return bytes([self.status, 0, 0, 0, self.state, 0])

    def download(self, block, content):
        if block >= 2:
            if not self.chip.program(self.pointer + (block - 2) * TRANSFER_SIZE, content):
                self.status = ERROR_WRITE
        elif content[:1] == b"\x41" and len(content) == 1:
            self.chip.record(("mass erase",))
        elif content[:1] in (b"\x41", b"\x21") and len(content) == 5:
            address, = struct.unpack("<I", content[1:])
            if not FLASH <= address < FLASH + SIZE:
                self.status = ERROR_ADDRESS
            elif content[:1] == b"\x21":
                self.pointer = address
            elif not self.chip.erase(sector_of(address)):
                self.status = ERROR_WRITE
        else:
            self.status = ERROR_VENDOR
