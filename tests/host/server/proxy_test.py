"""proxy_test.py HOST_COUNTING_ROBOT: the server behind a reverse proxy, as docs/reverse-proxy.md says it."""

import base64
import os
import re
import socket
import threading

from served_page import FILES, run_tests
from web_client import Viewer, request, status

SITE = "https://robot.example"


class Proxy:
    """Passes connections on to a server, without the path `prefix`. replaced: the fields that it replaces, by functions of their values."""

    def __init__(self, port, prefix="", **replaced):
        self.server, self.prefix, self.replaced = port, prefix, {name.lower(): change for name, change in replaced.items()}
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            client, _ = self.listener.accept()
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        head = b""
        while b"\r\n\r\n" not in head:
            part = client.recv(65536)
            if not part:
                return client.close()
            head += part
        head, _, rest = head.partition(b"\r\n\r\n")
        first, *fields = head.decode().split("\r\n")
        lines = [first.replace(f" {self.prefix}/", " /", 1)]
        for field in fields:
            name, value = field.split(": ", 1)
            lines.append(f"{name}: {self.replaced.get(name.lower(), lambda same: same)(value)}")
        lines.append("X-Forwarded-For: 192.0.2.1\r\nX-Forwarded-Host: 127.0.0.1\r\nForwarded: host=127.0.0.1")
        server = socket.create_connection(("127.0.0.1", self.server))
        server.sendall("\r\n".join(lines).encode() + b"\r\n\r\n" + rest)
        for source, sink in ((client, server), (server, client)):
            threading.Thread(target=self.pass_on, args=(source, sink), daemon=True).start()

    @staticmethod
    def pass_on(source, sink):
        try:
            while data := source.recv(65536):
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)
        except OSError:
            pass


def as_documented(server, prefix=""):
    """Host is replaced, and Origin if it is that of the site."""
    own = f"127.0.0.1:{server.port}"
    return Proxy(server.port, prefix, Host=lambda _: own, Origin=lambda origin: f"http://{own}" if origin == SITE else origin)


def upgrade(origin):
    key = base64.b64encode(os.urandom(16)).decode()
    return ["Upgrade: websocket", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", f"Origin: {origin}"]


def test_with_both_fields_replaced_all_works(server):
    for prefix in ("", "/lab"):
        proxy = as_documented(server, prefix)
        for name in ("", "app.js", "icons/a.svg"):
            first, _, body = request(proxy.port, path=f"{prefix}/{name}", host="robot.example", fields=[f"Origin: {SITE}"])
            assert first == "HTTP/1.1 200 OK" and body == FILES[name or "index.html"], (prefix, name, first)
        with Viewer(proxy.port, server.token, path=f"{prefix}/socket", fields=[f"Origin: {SITE}"]) as viewer:
            assert viewer.do("value")["ok"]
            for word in ("Bearer", "bearer"):
                stop = [f"Origin: {SITE}", f"Authorization: {word} {server.token}"]
                assert status(proxy.port, "POST", f"{prefix}/stop", stop, host="robot.example") == 200
            viewer.until(lambda: viewer.documents.get("session", {}).get("value", {}).get("state") == "stopped")


def test_other_sites_stay_out(server):
    proxy = as_documented(server)
    for origin in ("https://evil.example", "null", "http://robot.example", f"{SITE}.evil.example", f"{SITE}:444", "https://127.0.0.1"):
        assert status(proxy.port, fields=[f"Origin: {origin}"], host="robot.example") == 403, origin
        assert status(proxy.port, path="/socket", fields=[*upgrade(origin), "Connection: Upgrade"], host="robot.example") == 403, origin
        stop = [f"Origin: {origin}", f"Authorization: Bearer {server.token}"]
        assert status(proxy.port, "POST", "/stop", stop, host="robot.example") == 403, origin


def test_what_a_proxy_leaves_out_is_said(server):
    own = f"127.0.0.1:{server.port}"
    plain = Proxy(server.port)
    first, _, body = request(plain.port, host="robot.example", fields=[f"Origin: {SITE}"])
    assert " 421 " in first and b"Host: found 'robot.example', expected a name and the port of this page, such as '%s'" % own.encode() in body, body
    only_host = Proxy(server.port, Host=lambda _: own)
    assert status(only_host.port, host="robot.example") == 200
    for path, fields in (("/", [f"Origin: {SITE}"]), ("/socket", [*upgrade(SITE), "Connection: Upgrade"])):
        first, _, body = request(only_host.port, path=path, host="robot.example", fields=fields)
        assert " 403 " in first, first
        assert re.match(rb"Origin: found 'https://robot.example', expected that of the Host, 'http://%s'" % own.encode(), body), body
        assert b"docs/reverse-proxy.md" in body, body


def test_forwarded_fields_are_not_trusted(server):
    own = f"127.0.0.1:{server.port}"
    for field in (f"X-Forwarded-Host: {own}", f"Forwarded: host={own}", f"X-Original-Host: {own}"):
        assert status(server.port, host="robot.example", fields=[field]) == 421, field
    assert status(server.port, fields=["X-Forwarded-Proto: https", f"Origin: https://{own}"]) == 403


run_tests(dict(globals()))
