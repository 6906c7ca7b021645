"""requests_test.py HOST_COUNTING_ROBOT: what the server answers to HTTP requests (docs/page-interface.md, "Addresses")."""

from served_page import FILES, run_tests
from web_client import Viewer, connect, exchange, read_all, request, status

HEADER = {
    "x-content-type-options": "nosniff",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "cache-control": "no-store",
}
SECURITY_POLICY = ("default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
                   "connect-src 'self' ws://{}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'")


def test_the_files_of_the_page_need_no_token(server):
    for path, name, kind in (("/", "index.html", "text/html; charset=utf-8"), ("/index.html", "index.html", "text/html; charset=utf-8"),
                             ("/app.js?1", "app.js", "text/javascript; charset=utf-8"), ("/icons/a.svg", "icons/a.svg", "image/svg+xml")):
        first, fields, body = request(server.port, path=path)
        assert first == "HTTP/1.1 200 OK", first
        assert body == FILES[name] and int(fields["content-length"]) == len(body), path
        assert fields["content-type"] == kind, fields
        for field, value in HEADER.items():
            assert fields[field] == value, fields
        assert fields["content-security-policy"] == SECURITY_POLICY.format(f"127.0.0.1:{server.port}"), fields


def test_errors_have_the_same_header(server):
    for host in (None, "evil.example"):
        _, fields, _ = request(server.port, path="/missing", host=host)
        for field, value in HEADER.items():
            assert fields[field] == value, fields
        assert "evil" not in str(fields)


def test_head_has_the_header_of_get_and_no_body(server):
    first, fields, body = request(server.port, "HEAD", "/app.js")
    assert first == "HTTP/1.1 200 OK" and body == b"", (first, body)
    assert int(fields["content-length"]) == len(FILES["app.js"])


def test_several_requests_use_one_connection(server):
    one = f"GET /icons/a.svg HTTP/1.1\r\nHost: localhost:{server.port}\r\n\r\n".encode()
    last = one.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n")
    assert exchange(server.port, one + one + last).count(b"<svg/>") == 3


def test_a_foreign_host_is_refused(server):
    """DNS rebinding: a name of an attacker that resolves to this computer."""
    for host in ("localhost", "127.0.0.1", "[::1]"):
        assert status(server.port, host=f"{host}:{server.port}") == 200, host
    for host in ("evil.example", f"evil.example:{server.port}", "localhost", "127.0.0.1", f"127.0.0.1:{server.port + 1}",
                 f"localhost.evil.example:{server.port}", f"127.0.0.1:{server.port}.evil.example", f"0.0.0.0:{server.port}",
                 f"localhost:{server.port}@evil.example", f"xlocalhost:{server.port}"):
        for path in ("/", "/socket", "/missing"):
            assert status(server.port, path=path, host=host) == 421, host
        assert status(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"], host=host) == 421, host
    # The other end of a tunnel has another port: the body says what to do.
    body = exchange(server.port, b"GET / HTTP/1.1\r\nHost: localhost:9000\r\nConnection: close\r\n\r\n")
    assert f"ssh -L {server.port}:127.0.0.1:{server.port} HOST".encode() in body, body
    assert f"http://localhost:{server.port}".encode() in body and b"9000" not in body, body
    assert status(server.port, fields=["Host: evil.example"]) == 421, "two hosts"
    assert b" 421 " in exchange(server.port, b"GET / HTTP/1.1\r\nConnection: close\r\n\r\n"), "no host"


def test_a_foreign_origin_is_refused(server):
    own = f"127.0.0.1:{server.port}"
    assert status(server.port, fields=[f"Origin: http://{own}"]) == 200
    for origin in ("http://evil.example", "null", f"https://{own}", f"http://{own}.evil.example", f"http://localhost:{server.port}",
                   f"http://{own}/", "http://127.0.0.1", ""):
        assert status(server.port, fields=[f"Origin: {origin}"]) == 403, origin
        socket = ["Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Version: 13"]
        assert status(server.port, path="/socket", fields=[*socket, f"Origin: {origin}"]) == 403, origin
        stop = [f"Authorization: Bearer {server.token}", f"Origin: {origin}"]
        assert status(server.port, "POST", "/stop", stop) == 403, origin
    assert status(server.port, fields=[f"Origin: http://{own}", f"Origin: http://{own}"]) == 403, "two origins"
    Viewer(server.port, server.token, fields=[f"Origin: http://{own}"]).sock.close()


def test_no_path_leads_out_of_the_folder(server):
    for path in ("/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/icons/../../secret.txt", "//etc/passwd", "/etc/passwd",
                 "/.", "/..", "/icons", "/icons/", "/index.html/", "/\\..\\secret.txt", "/index.html%00", "http://evil.example/", "*",
                 f"http://127.0.0.1/index.html", "/./index.html", "/INDEX.HTML"):
        assert status(server.port, path=path) == 404, path


def test_other_methods_are_refused(server):
    for method in ("PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "get", "ANYTHING"):
        assert status(server.port, method) == 405, method
    assert status(server.port, "POST", "/") == 405
    assert status(server.port, "GET", "/stop") == 405


def test_stop_by_post_needs_the_token(server):
    def post(*fields, body=b""):
        return status(server.port, "POST", "/stop", fields, body=body)

    wrong = server.token[:-1] + ("A" if server.token[-1] != "A" else "B")
    form = ("Content-Type: application/x-www-form-urlencoded",)
    for fields in ((), (f"Authorization: Bearer {wrong}",), (f"Authorization: Bearer {server.token}A",), ("Authorization: Bearer ",),
                   (f"Authorization: {server.token}",), (f"Authorization: Basic {server.token}",), form,
                   (f"Authorization: Bearer {server.token}", "Authorization: Bearer x")):
        assert post(*fields) == 401, fields
    assert post(*form, body=f"token={server.token}".encode()) == 401, "a form"
    with server.viewer() as viewer:
        viewer.until(lambda: "session" in viewer.documents)
        assert viewer.documents["session"]["value"]["state"] == "running"
        first, _, body = request(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"])
        assert first == "HTTP/1.1 200 OK" and body == b'{"stopped": true}', (first, body)
        viewer.until(lambda: viewer.documents["session"]["value"]["state"] == "stopped")
        viewer.until(lambda: "stopped by POST /stop" in viewer.notices)


def test_requests_that_are_too_large_are_refused(server):
    assert status(server.port, fields=["X: " + "x" * 9000]) == 431
    assert status(server.port, path="/" + "x" * 9000) == 431
    assert status(server.port, "POST", "/stop", body=b"x" * 5000) == 413
    with connect(server.port) as sock:  # a field without an end
        sock.sendall(b"GET / HTTP/1.1\r\nX: " + b"x" * 20000)
        assert b" 431 " in read_all(sock)
    with connect(server.port) as sock:  # the length alone decides
        sock.sendall(f"POST /stop HTTP/1.1\r\nHost: localhost:{server.port}\r\nContent-Length: 10000000000\r\n\r\n".encode())
        assert b" 413 " in read_all(sock)


def test_the_socket_needs_an_upgrade(server):
    assert status(server.port, path="/socket") == 426


def test_what_is_not_http_is_refused(server):
    for junk in (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" * 20 + b"\r\n\r\n", b"\0" * 100, b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
                 b"GET / HTTP/1.1\r\nbad field\r\n\r\n", b"POST /stop HTTP/1.1\r\nContent-Length: -1\r\n\r\n"):
        answer = exchange(server.port, junk)
        assert b" 400 " in answer or answer == b"", answer
    # Chunks beside a length (request smuggling).
    smuggled = exchange(server.port, f"POST /stop HTTP/1.1\r\nHost: localhost:{server.port}\r\nContent-Length: 4\r\n"
                        "Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n0\r\n\r\n".encode())
    assert b" 200 " not in smuggled, smuggled


run_tests(dict(globals()))
