#!/usr/bin/python3
"""RFCOMM between the lab's two Bluetooth controllers: data arrives complete and unchanged both ways; a channel on which
nobody listens refuses."""

import random
import socket
import subprocess
import sys
import threading

TIMEOUT_S = 30
CHANNEL = 5
SEED = 20131104
SIZE = 100_000


def address_of(controller):
    output = subprocess.run(["hciconfig", controller], capture_output=True, text=True, check=True).stdout
    return output.split("BD Address: ")[1].split()[0]


def rfcomm():
    line = socket.socket(socket.AF_BLUETOOTH, socket.SOCK_STREAM, socket.BTPROTO_RFCOMM)
    line.settimeout(TIMEOUT_S)
    return line


def echo(listener):
    line, _ = listener.accept()
    line.settimeout(TIMEOUT_S)
    while content := line.recv(4096):
        line.sendall(content)


def main():
    print(f"seed {SEED}")
    content = random.Random(SEED).randbytes(SIZE)
    near, far = address_of("hci0"), address_of("hci1")
    listener = rfcomm()
    listener.bind((far, CHANNEL))
    listener.listen(1)
    threading.Thread(target=echo, args=(listener,), daemon=True).start()

    line = rfcomm()
    line.bind((near, 0))
    line.connect((far, CHANNEL))
    threading.Thread(target=line.sendall, args=(content,), daemon=True).start()
    received = b""
    while len(received) < SIZE:
        part = line.recv(4096)
        if not part:
            sys.exit(f"found the end of the line after {len(received)} bytes, expected {SIZE}")
        received += part
    if received != content:
        sys.exit("found other bytes, expected those that were sent")

    # The first connection is still open. Without it, the end of the session between the controllers can overtake: ECONNRESET.
    refused = rfcomm()
    refused.bind((near, 0))
    try:
        refused.connect((far, CHANNEL + 1))
    except ConnectionRefusedError:
        return
    sys.exit("found a connection on a channel without a listener, expected ECONNREFUSED")


if __name__ == "__main__":
    main()
