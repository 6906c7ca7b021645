"""A WebSocket client of its own, with what a browser would not do: RFC 6455 on a plain socket, and HTTP requests as bytes."""

import base64
import hashlib
import json
import os
import select
import socket
import ssl
import struct
import threading
import time

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
WAIT_S = 300  # a limit for a test that fails, not a requirement
TLS = None  # an ssl.SSLContext: connections are encrypted
GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


class Closed(Exception):
    """The server ended the connection: code and reason of its close frame; None without one."""

    def __init__(self, code=None, reason=""):
        super().__init__(code, reason)
        self.code = code
        self.reason = reason


class EncryptedSocket(ssl.SSLSocket):
    """Reports the end of a connection as a plain socket does."""

    def sendall(self, data, flags=0):
        try:
            super().sendall(data, flags)
        except ssl.SSLError as error:
            raise ConnectionResetError from error

    def recv(self, size=1024, flags=0):
        try:
            return super().recv(size, flags)
        except ssl.SSLError as error:
            raise ConnectionResetError from error


def connect(port, receive_buffer=None, source=None):
    """source: an address of this computer, such as 127.0.0.5, from which the connection comes: another computer for the server."""
    sock = socket.socket()
    if source:
        sock.bind((source, 0))
    if receive_buffer:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    sock.settimeout(WAIT_S)
    sock.connect(("127.0.0.1", port))
    # Otherwise a message waits until the one before is confirmed, up to 40 ms of the computer's time: virtual time passes.
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return TLS.wrap_socket(sock, server_hostname="localhost") if TLS else sock


def read_all(sock):
    data = b""
    try:
        while part := sock.recv(65536):
            data += part
    except ConnectionResetError:
        pass
    return data


def exchange(port, request, source=None):
    """The bytes that the server sends for the bytes of a request until it ends the connection."""
    with connect(port, source=source) as sock:
        try:
            sock.sendall(request)
        except (BrokenPipeError, ConnectionResetError):
            pass
        return read_all(sock)


def status(port, method="GET", path="/", fields=(), host=None, body=b"", version="1.1"):
    return int(request(port, method, path, fields, host, body, version)[0].split()[1])


def request(port, method="GET", path="/", fields=(), host=None, body=b"", version="1.1", source=None):
    """Status line, header fields in lower case, body."""
    lines = [f"{method} {path} HTTP/{version}", f"Host: {host or f'127.0.0.1:{port}'}", "Connection: close", *fields]
    if body:
        lines.append(f"Content-Length: {len(body)}")
    answer = exchange(port, "\r\n".join(lines).encode() + b"\r\n\r\n" + body, source)
    head, _, content = answer.partition(b"\r\n\r\n")
    first, *rest = head.decode().split("\r\n")
    return first, {name.lower(): value for name, value in (line.split(": ", 1) for line in rest)}, content


def frame(opcode, payload, masked=True, final=True):
    size = len(payload)
    first = bytes([opcode | (0x80 if final else 0)])
    flag = 0x80 if masked else 0
    if size < 126:
        head = first + bytes([flag | size])
    elif size < 65536:
        head = first + bytes([flag | 126]) + struct.pack(">H", size)
    else:
        head = first + bytes([flag | 127]) + struct.pack(">Q", size)
    if not masked:
        return head + payload
    mask = os.urandom(4)
    pattern = int.from_bytes(mask * (size // 4 + 1), "big") >> (8 * (4 - size % 4))
    data = (int.from_bytes(payload, "big") ^ pattern).to_bytes(size, "big") if size else b""
    return head + mask + data


class Viewer:
    def __init__(self, port, token=None, name="viewer", fields=(), only=None, receive_buffer=None, wants_control=False,
                 path="/socket", source=None):
        self.sock = connect(port, receive_buffer, source)
        self.data = b""
        self.documents = {}
        self.results = {}
        self.notices = []
        self.rows = []
        self.stops = []
        self.last_id = 0
        key = base64.b64encode(os.urandom(16))
        lines = [f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key.decode()}", "Sec-WebSocket-Version: 13", *fields]
        self.sock.sendall("\r\n".join(lines).encode() + b"\r\n\r\n")
        while b"\r\n\r\n" not in self.data:
            self.fill()
        head, _, self.data = self.data.partition(b"\r\n\r\n")
        assert head.startswith(b"HTTP/1.1 101"), head
        assert base64.b64encode(hashlib.sha1(key + GUID).digest()) in head, "the key of the handshake"
        if token is not None:
            hello = {"type": "hello", "protocol": 1, "token": token, "name": name}
            self.send({**hello, **({"only": only} if only else {}), **({"wants_control": True} if wants_control else {})})
            self.welcome = self.next()
            assert self.welcome["type"] == "welcome", self.welcome

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.sock.close()

    def fill(self):
        try:
            part = self.sock.recv(1 << 20)
        except ConnectionResetError:
            part = b""
        if not part:
            raise Closed
        self.data += part

    def take(self, size):
        parts = [self.data]
        missing = size - len(self.data)
        while missing > 0:
            self.data = b""
            self.fill()
            parts.append(self.data)
            missing -= len(self.data)
        self.data = b"".join(parts)
        part, self.data = self.data[:size], self.data[size:]
        return part

    def send_bytes(self, data):
        self.sock.sendall(data)

    def send(self, message):
        self.send_bytes(frame(TEXT, json.dumps(message).encode()))

    def next_frame(self):
        first, second = self.take(2)
        assert second < 0x80, "a server does not mask"
        size = second
        if size == 126:
            size = struct.unpack(">H", self.take(2))[0]
        elif size == 127:
            size = struct.unpack(">Q", self.take(8))[0]
        payload = self.take(size)
        opcode = first & 15
        if opcode == CLOSE:
            code = struct.unpack(">H", payload[:2])[0] if payload else None
            raise Closed(code, payload[2:].decode())
        assert first & 0x80, "a message is one frame"
        return opcode, payload

    def next(self):
        """The next message, which is also sorted into documents, results, and so on."""
        opcode, payload = self.next_frame()
        if opcode == PING:
            self.send_bytes(frame(PONG, payload))
            return self.next()
        if opcode == BINARY and payload[:4] == bytes(4):  # an answer in bytes
            number = struct.unpack("<Q", payload[8:16])[0]
            self.results[number] = {"ok": True, "value": payload[16:]}
            return {"type": "bytes", "id": number}
        if opcode == BINARY:
            message = {"type": "rows", **decode_rows(payload)}
            self.rows.append(message)
            return message
        if opcode == PONG:
            return {"type": "pong", "payload": payload}
        message = json.loads(payload)
        kind = message["type"]
        if kind == "document":
            self.documents[message["name"]] = message
        elif kind == "result":
            assert message["id"] not in self.results, "one result for each operation"
            self.results[message["id"]] = message
        elif kind == "notice":
            self.notices.append(message["text"])
        elif kind == "stopped":
            self.stops.append(message)
        return message

    def until(self, condition):
        """Reads messages until the condition holds."""
        end = time.monotonic() + WAIT_S
        while not condition():
            assert time.monotonic() < end, f"the condition does not hold after {WAIT_S} s"
            self.next()

    def until_closed(self):
        try:
            while True:
                self.next()
        except Closed as closed:
            return closed

    def start(self, name, epoch=0, /, **arguments):
        self.last_id += 1
        self.send({"type": "operation", "id": self.last_id, "epoch": epoch, "name": name, "arguments": arguments})
        return self.last_id

    def result(self, number):
        self.until(lambda: number in self.results)
        return self.results[number]

    def do(self, name, epoch=0, /, **arguments):
        return self.result(self.start(name, epoch, **arguments))

    def control(self):
        return self.documents["control"]["value"]

    def take_control(self):
        result = self.do("control.take")
        assert result["ok"], result
        return result["value"]["epoch"]

    def has_data(self, wait_s):
        return bool(self.data) or bool(select.select([self.sock], [], [], wait_s)[0])


def live(viewer):
    """Says some times a second that a page lives, as long as the event that this returns is set."""
    lives = threading.Event()
    lives.set()
    send, lock = viewer.send_bytes, threading.Lock()

    def send_alone(data):
        with lock:
            send(data)

    def beat():
        while lives.wait():
            try:
                viewer.send({"type": "beat", "age_ms": 0})
            except OSError:
                return
            time.sleep(0.1)

    viewer.send_bytes = send_alone
    threading.Thread(target=beat, daemon=True).start()
    return lives


def decode_rows(payload):
    number, tick, count, stride, run, flags = struct.unpack("<IIHHHH", payload[:16])
    values = struct.unpack(f"<{(len(payload) - 16) // 4}i", payload[16:])
    width = len(values) // count
    return {"subscription": number, "tick": tick, "stride": stride, "run": run, "gap": flags & 1,
            "values": [values[i * width:(i + 1) * width] for i in range(count)]}
