"""attacks_test.py HOST_COUNTING_ROBOT: programs that break the rules of the connection, and viewers that do not read. The server
ends their connections, its memory stays bounded, and the other viewers notice nothing."""

import json
import random
import socket
import time

from served_page import run_tests
from web_client import BINARY, CLOSE, PING, TEXT, WAIT_S, Closed, Viewer, connect, frame, read_all, request, status

SEED = 1
print("seed", SEED)


def hello(server, **changes):
    return {"type": "hello", "protocol": 1, "token": server.token, "name": "attacker", **changes}


def closed_after(server, *messages, greet=True):
    """How the server ends the connection of a viewer that sends these bytes."""
    viewer = Viewer(server.port, server.token if greet else None)
    try:
        for message in messages:
            viewer.send_bytes(message)
    except (BrokenPipeError, ConnectionResetError):
        pass
    closed = viewer.until_closed()
    viewer.sock.close()
    return closed


def text(message):
    return frame(TEXT, json.dumps(message).encode())


def expect_works(server):
    with server.viewer() as viewer:
        assert viewer.do("value")["ok"]


def test_without_the_token_nothing_is_told(server):
    wrong = server.token[:-1] + ("A" if server.token[-1] != "A" else "B")
    for token in (wrong, "", server.token + "A", server.token[:-1]):
        viewer = Viewer(server.port)
        viewer.send(hello(server, token=token))
        closed = viewer.until_closed()
        assert closed.code == 1008 and closed.reason.startswith("hello: found a wrong token"), closed
        assert not viewer.documents and not viewer.notices
        viewer.sock.close()
    assert closed_after(server, text(hello(server, protocol=2)), greet=False).reason == "hello: found protocol 2, expected 1"


def test_hello_is_the_first_message(server):
    for message in ({"type": "stop"}, {"type": "beat", "age_ms": 0}, {"type": "subscribe", "signals": []},
                    {"type": "operation", "id": 1, "epoch": 1, "name": "value", "arguments": {}}):
        closed = closed_after(server, text(message), text(hello(server)), greet=False)
        assert closed.code == 1008 and closed.reason.startswith("message: found no hello"), closed
    with server.viewer() as viewer:
        viewer.until(lambda: "session" in viewer.documents)
        assert viewer.documents["session"]["value"]["state"] == "running", "a STOP without the token has no effect"
    assert closed_after(server, text(hello(server))).reason.startswith("message: found a second hello")


def test_a_socket_without_hello_is_closed(server):
    viewer = Viewer(server.port)
    closed = viewer.until_closed()
    assert closed.code == 1008 and closed.reason.startswith("found no hello within 2 s"), closed
    viewer.sock.close()


def test_messages_of_another_form_end_the_connection(server):
    operation = {"type": "operation", "id": 1, "epoch": 1, "name": "value", "arguments": {}}
    bad = [b"", b"x", b"[]", b"1", b"null", b"{}", b'{"type":', b'{"type": 1}', b'{"type": "stop"} x', b'{"type": "halt"}', b"\xef\xbb\xbf{",
           b"[" * 10000, b'{"type":' * 5000, b'{"type": "stop", "x": ' + b"[" * 20 + b"]" * 20 + b"}", b'{"type": "beat", "age_ms": 1e999}',
           b'{"type": "\\ud800"}', *[json.dumps(message).encode() for message in (
               {**operation, "id": -1}, {**operation, "id": 1.5}, {**operation, "id": "1"}, {**operation, "id": 2**60}, {**operation, "epoch": None},
               {**operation, "name": 7}, {**operation, "arguments": []}, {**operation, "arguments": None}, {"type": "operation"},
               {"type": "beat"}, {"type": "beat", "age_ms": -1}, {"type": "beat", "age_ms": "1"}, {"type": "subscribe"},
               {"type": "subscribe", "signals": "angle"}, {"type": "subscribe", "signals": [1]},
               {"type": "subscribe", "signals": ["angle", "angle"]}, {"type": "subscribe", "signals": [str(i) for i in range(65)]})]]
    for message in bad:
        closed = closed_after(server, frame(TEXT, message))
        assert closed.code == 1008 and closed.reason, (message[:100], closed)
    for name in ("", "x" * 61, "line\nend", "\x7f"):
        closed = closed_after(server, text(hello(server, name=name)), greet=False)
        assert closed.code == 1008, (name, closed)
    descending = closed_after(server, text({**operation, "id": 5}), text({**operation, "id": 5}))
    assert descending.reason == "operation: found id 5, expected one above 5", descending
    assert closed_after(server, frame(BINARY, b"123")).code == 1008
    assert closed_after(server, frame(TEXT, b"\xff\xfe")).code == 1007, "text that is not UTF-8"


def test_frames_that_break_the_protocol_end_the_connection(server):
    for data in (frame(TEXT, b"{}", masked=False), frame(3, b"x"), frame(11, b"x"), frame(0, b"x"), frame(PING, b"x" * 126),
                 frame(PING, b"x", final=False), b"\xc1\x80\0\0\0\0", frame(TEXT, b"x", final=False) + frame(TEXT, b"x"),
                 frame(CLOSE, b"\x03"), frame(CLOSE, b"\x00\x01")):
        closed = closed_after(server, data)
        assert closed.code in (1002, None), (data, closed)
    expect_works(server)


def test_a_long_message_ends_the_connection(server):
    assert closed_after(server, frame(TEXT, b'"' + b"x" * 10_000_000 + b'"')).code in (1009, None)
    assert closed_after(server, b"\x81\xff" + (2**62).to_bytes(8, "big") + b"mask").code in (1009, None), "the length alone decides"
    parts = frame(TEXT, b"x" * 60000, final=False) + frame(0, b"x" * 60000)
    assert closed_after(server, parts).code in (1009, None), "in parts"
    with server.viewer() as viewer:
        viewer.send({"type": "beat", "age_ms": 1, "x": "x" * 60000})
        assert viewer.do("value")["ok"], "up to 64 KiB are allowed"


def test_junk_behind_the_upgrade_ends_the_connection(server):
    """And leaves nothing behind: the server ends at the end of this test."""
    generator = random.Random(SEED)
    for _ in range(50):
        closed_after(server, bytes(generator.randrange(256) for _ in range(2000)), greet=False)
        closed_after(server, bytes(generator.randrange(256) for _ in range(2000)))
    lines = ["GET /socket HTTP/1.1", f"Host: 127.0.0.1:{server.port}", "Upgrade: websocket", "Connection: Upgrade",
             "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Version: 13"]
    early = "\r\n".join(lines).encode() + b"\r\n\r\n"
    with connect(server.port) as sock:
        sock.sendall(early + text(hello(server)))
        assert b" 400 " in read_all(sock), "frames before the answer to the upgrade"
    for missing in (4, 5):
        fields = lines[1:missing] + lines[missing + 1:]
        with connect(server.port) as sock:
            sock.sendall("\r\n".join([lines[0], *fields]).encode() + b"\r\n\r\n")
            answer = sock.recv(4096)
            assert b" 101 " not in answer and answer.startswith(b"HTTP/1.1 4"), answer
    expect_works(server)


def test_connections_beyond_the_limit_can_only_stop(server):
    """55 connections beside the viewer may ask for anything, 8 only for STOP; a newer one ends the oldest of these 8."""
    with server.viewer() as viewer:
        viewers = [server.viewer() for _ in range(55)]
        opened = [connect(server.port) for _ in range(200)]
        for path in ("/", "/app.js", "/missing"):
            assert status(server.port, path=path) == 503, path
        assert status(server.port, host="evil.example") == 421
        assert status(server.port, "POST", "/stop") == 401
        viewer.until(lambda: "session" in viewer.documents)
        assert viewer.documents["session"]["value"]["state"] == "running"
        first, fields, _ = request(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"])
        assert first == "HTTP/1.1 200 OK" and fields["connection"] == "close", (first, fields)
        viewer.until(lambda: viewer.documents["session"]["value"]["state"] == "stopped")
        for sock in opened[:200 - 8]:
            assert read_all(sock) == b""
        viewer.send({"type": "stop"})
        viewer.until(lambda: viewer.stops)
        for sock in (*opened, *(other.sock for other in viewers)):
            sock.close()
        while status(server.port) == 503:
            pass


def test_half_a_request_is_not_waited_for(server):
    half = [connect(server.port) for _ in range(64)]
    for i, sock in enumerate(half):
        sock.sendall([b"", b"GET / HTTP/1.1\r\nHost:", b"POST /stop HTTP/1.1\r\nContent-Length: 100\r\n\r\nx"][i % 3])
    for sock in half:
        read_all(sock)  # ends when the server closes
        sock.close()
    assert status(server.port) == 200


def test_slow_writing_does_not_prolong_a_request(server):
    with connect(server.port) as sock:
        end = time.monotonic() + WAIT_S
        try:
            while time.monotonic() < end:
                sock.sendall(b"G")
                time.sleep(0.1)
            raise AssertionError(f"the connection is open after {WAIT_S} s, expected that it is closed after 5 s")
        except (BrokenPipeError, ConnectionResetError):
            pass


def test_a_viewer_that_does_not_read_costs_little_memory(server):
    """Telemetry at 4,000 ticks a second and 600 revisions of a document of 100 kB: 60 MB would wait for each of the slow viewers."""
    with server.viewer("fast") as fast:
        fast.until(lambda: "telemetry" in fast.documents)
        epoch = fast.take_control()
        fast.do("rate", epoch, ticks_per_second=4000)
        slow = [server.viewer(f"slow {i}", receive_buffer=65536) for i in range(8)]
        for viewer in slow:
            viewer.send({"type": "subscribe", "signals": ["angle", "contact", "count"]})
        fast.send({"type": "subscribe", "signals": ["count"]})
        before = fast.do("rss")["value"]["kib"]
        for _ in range(30):
            assert fast.do("large", bytes=100_000, times=20)["ok"]
            for viewer in (fast, *slow):
                viewer.send({"type": "beat", "age_ms": 1})  # not silent
        after = fast.do("rss")["value"]["kib"]
        print(f"  resident memory: {before} KiB, then {after} KiB")
        assert after < before + 32 * 1024
        rows = len(fast.rows)
        fast.until(lambda: len(fast.rows) > rows + 10)
        for viewer in slow:  # it reads at last: the newest revision, and rows of now
            viewer.until(lambda v=viewer: v.documents.get("large", {}).get("value", {}).get("number") == 19)
            revisions = fast.documents["large"]["revision"]
            viewer.until(lambda v=viewer: v.documents["large"]["revision"] == revisions)
            viewer.until(lambda v=viewer: v.rows and v.rows[-1]["tick"] >= fast.rows[-1]["tick"] - 8192)
            viewer.sock.close()


def test_stop_works_while_a_viewer_is_stalled(server):
    """Nothing reaches the page any more, but what it sends does."""
    stalled = server.viewer("stalled", receive_buffer=65536)
    with server.viewer("other") as other:
        stalled.start("large", bytes=8_000_000, times=1)
        other.until(lambda: "large" in other.documents)
        stalled.send({"type": "stop"})
        other.until(lambda: "stopped by stalled" in other.notices)
        other.until(lambda: other.documents["session"]["value"]["state"] == "stopped")
        epoch = other.take_control()
        assert other.do("run", epoch)["ok"]
        first, _, _ = request(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"])
        assert first == "HTTP/1.1 200 OK", first
        other.until(lambda: "stopped by POST /stop" in other.notices)
    stalled.until(lambda: stalled.stops)
    stalled.sock.close()


def test_too_many_operations_at_once_are_refused(server):
    with server.viewer() as viewer:
        waiting = [viewer.start("wait") for _ in range(64)]
        refused = viewer.start("value")
        assert viewer.result(refused)["error"] == "too many operations at once"
        assert not set(waiting) & viewer.results.keys()
        with server.viewer("other") as other:
            assert other.do("value")["ok"], "the limit is for each viewer"
            viewer.send({"type": "stop"})
            viewer.until(lambda: viewer.stops)
            assert other.do("finish")["ok"]
        assert all(viewer.result(number)["ok"] for number in waiting)
        assert viewer.do("value")["ok"]


def test_a_flood_of_operations_ends_the_connection(server):
    """200,000 operations whose answers nobody reads."""
    with server.viewer() as other:
        flood = server.viewer("flood", receive_buffer=4096)
        before = other.do("rss")["value"]["kib"]
        try:
            for first in range(1, 200_001, 2000):
                flood.send_bytes(b"".join(text({"type": "operation", "id": number, "epoch": 0, "name": "add"})
                                          for number in range(first, first + 2000)))
            ended = flood.until_closed()
        except (BrokenPipeError, ConnectionResetError, TimeoutError):
            ended = Closed()
        assert ended.code in (None, 1008), ended
        after = other.do("rss")["value"]["kib"]
        print(f"  resident memory: {before} KiB, then {after} KiB")
        assert after < before + 24 * 1024
        flood.sock.close()


def test_a_flood_of_stops_stops(server):
    with server.viewer() as other:
        flood = server.viewer("flood", receive_buffer=4096)
        before = other.do("rss")["value"]["kib"]
        part = text({"type": "stop"}) * 1000
        for _ in range(20):
            flood.send_bytes(part)
        other.until(lambda: other.documents.get("session", {}).get("value", {}).get("state") == "stopped")
        after = other.do("rss")["value"]["kib"]
        print(f"  resident memory: {before} KiB, then {after} KiB")
        assert after < before + 16 * 1024
        flood.until(lambda: flood.stops)
        flood.sock.close()


def test_viewers_that_vanish_leave_nothing_behind(server):
    for i in range(150):
        viewer = server.viewer(f"short {i}")
        viewer.send({"type": "subscribe", "signals": ["angle"]})
        viewer.start("control.take")
        viewer.start("wait")
        if i % 3 == 0:  # a reset instead of an end
            viewer.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        viewer.sock.close()
    with server.viewer() as viewer:
        assert viewer.do("control.take")["ok"]
        assert viewer.do("finish")["ok"]


def test_the_server_ends_beside_a_stalled_viewer(server):
    stalled = server.viewer("stalled", receive_buffer=4096)
    with server.viewer("other") as other:
        stalled.start("large", bytes=8_000_000, times=1)
        other.until(lambda: "large" in other.documents)
    half = connect(server.port)
    half.sendall(b"GET")
    assert server.end() == "ended\n"
    half.close()
    stalled.sock.close()
    server.end = lambda: "ended\n"


run_tests(dict(globals()))
