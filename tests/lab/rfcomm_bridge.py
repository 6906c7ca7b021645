#!/usr/bin/python3
"""rfcomm_bridge.py ADDRESS CHANNEL PORT: a Bluetooth serial adapter at the robot. What arrives by RFCOMM at this controller
goes to the TCP port of `proleg bus`, and back; one connection after the other."""

import select
import socket
import sys


def pass_on(radio, robot):
    other = {radio: robot, robot: radio}
    while True:
        for line in select.select(list(other), [], [])[0]:
            content = line.recv(65536)
            if not content:
                return
            other[line].sendall(content)


address, channel, port = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
listener = socket.socket(socket.AF_BLUETOOTH, socket.SOCK_STREAM, socket.BTPROTO_RFCOMM)
listener.bind((address, channel))
listener.listen(1)
print("listens", flush=True)
while True:
    radio, _ = listener.accept()
    with radio, socket.create_connection(("127.0.0.1", port)) as robot:
        robot.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            pass_on(radio, robot)
        except OSError as error:
            print(error, flush=True)
