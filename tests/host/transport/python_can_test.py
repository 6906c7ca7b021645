"""python_can_test.py STAND_IN_BUS: two python-can programs, one on a pseudo terminal and one over TCP, exchange 2,000
frames in each direction through the slcan adapters of a bus server. None is lost, and nobody receives its own frames."""

import subprocess
import sys
import threading
import time

import can

FRAMES = 2000
LONGEST_WAIT_S = 300


def frame(number, identifier):
    return can.Message(arbitration_id=identifier, is_extended_id=False, data=number.to_bytes(4, "little") + b"\x01\xab\xcd\xef")


def receive(bus, received):
    end = time.monotonic() + LONGEST_WAIT_S
    while len(received) < FRAMES and time.monotonic() < end:
        message = bus.recv(0.1)
        if message is not None:
            received.append((message.arbitration_id, bytes(message.data)))


def send(bus, identifier):
    for number in range(FRAMES):
        bus.send(frame(number, identifier))


def main():
    with subprocess.Popen([sys.argv[1], "offer", "--fd", "0"], stdout=subprocess.PIPE, text=True) as server:
        try:
            name, port = server.stdout.readline().split()
            options = {"interface": "slcan", "bitrate": 1000000, "sleep_after_open": 0.1}
            terminal = can.Bus(channel=name, ttyBaudrate=1000000, **options)
            network = can.Bus(channel=f"socket://127.0.0.1:{port}", **options)
            for bus in (terminal, network):
                assert bus.get_version(LONGEST_WAIT_S) == (10, 10), "the answer to V"
                assert bus.get_serial_number(LONGEST_WAIT_S) == "0000", "the answer to N"
            for sender, receiver, identifier in ((terminal, network, 0x601), (network, terminal, 0x602)):
                received = []
                reader = threading.Thread(target=receive, args=(receiver, received))
                reader.start()
                send(sender, identifier)
                reader.join()
                expected = [(identifier, bytes(frame(number, identifier).data)) for number in range(FRAMES)]
                assert received == expected, f"{len(received)} frames received, expected {FRAMES}"
            for bus in (terminal, network):
                own = bus.recv(0.1)
                assert own is None or own.arbitration_id not in (0x601, 0x602), "nobody receives its own frames"
                bus.shutdown()
        finally:
            server.kill()


main()
