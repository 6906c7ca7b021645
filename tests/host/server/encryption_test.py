"""encryption_test.py HOST_COUNTING_ROBOT: the server with a certificate, for other computers: TLS only, by the names of the certificate."""

import socket
import ssl
import subprocess
import warnings

import web_client
from served_page import run_tests
from web_client import WAIT_S, read_all, request, status

NAMES = "DNS:Robot.example,DNS:*.wild.example,IP:192.0.2.7,IP:2001:db8::7,DNS:localhost"


def plain(port):
    return socket.create_connection(("127.0.0.1", port), timeout=WAIT_S)


def other_versions(newest):
    """A client that knows no newer TLS, and no limits for old ones."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    context.set_ciphers("ALL:@SECLEVEL=0")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        context.minimum_version = ssl.TLSVersion.TLSv1
        context.maximum_version = newest
    return context


def test_the_names_are_those_of_the_certificate_and_of_this_computer(server):
    for name in ("robot.example", "ROBOT.example", "robot.example.", "a.wild.example", "192.0.2.7", "[2001:db8::7]", "localhost", "127.0.0.1", "[::1]"):
        host = f"{name}:{server.port}"
        first, fields, _ = request(server.port, host=host, fields=[f"Origin: https://{host}"])
        assert first == "HTTP/1.1 200 OK", (host, first)
        assert f"connect-src 'self' wss://{host};" in fields["content-security-policy"], fields
        for origin in (f"http://{host}", "https://evil.example", f"https://{name}", "null"):
            assert status(server.port, host=host, fields=[f"Origin: {origin}"]) == 403, origin
    for name in ("evil.example", "test", "wild.example", "a.b.wild.example", "*.wild.example", "192.0.2.8", "robot.example.evil.example", "2001:db8::7"):
        assert status(server.port, host=f"{name}:{server.port}") == 421, name
    assert status(server.port, host="robot.example") == 421, "without the port"


def test_the_page_is_at_the_first_name(server):
    assert server.origin == f"https://robot.example:{server.port}"


def test_a_name_in_the_handshake_does_not_replace_the_host(server):
    for name in ("evil.example", "robot.example", None):
        context = other_versions(ssl.TLSVersion.TLSv1_3)
        for host, expected in (("evil.example", b" 421 "), ("robot.example", b" 200 ")):
            with context.wrap_socket(plain(server.port), server_hostname=name) as sock:
                sock.sendall(f"GET / HTTP/1.1\r\nHost: {host}:{server.port}\r\nConnection: close\r\n\r\n".encode())
                assert expected in read_all(sock).split(b"\r\n")[0], (name, host)


def test_old_versions_of_tls_are_refused(server):
    for newest, is_taken in ((ssl.TLSVersion.TLSv1, False), (ssl.TLSVersion.TLSv1_1, False), (ssl.TLSVersion.TLSv1_2, True)):
        try:
            with other_versions(newest).wrap_socket(plain(server.port)) as sock:
                assert is_taken and sock.version() == "TLSv1.2", sock.version()
        except (ssl.SSLError, ConnectionResetError):
            assert not is_taken, newest


def test_plain_text_is_closed(server):
    own = f"Host: localhost:{server.port}\r\n"
    for data in (f"GET / HTTP/1.1\r\n{own}\r\n", f"POST /stop HTTP/1.1\r\n{own}Authorization: Bearer {server.token}\r\n\r\n", "\0" * 100, "x" * 100_000):
        with plain(server.port) as sock:
            try:
                sock.sendall(data.encode())
            except (BrokenPipeError, ConnectionResetError):
                pass
            assert b"HTTP" not in read_all(sock)
    with server.viewer() as viewer:
        viewer.until(lambda: "session" in viewer.documents)
        assert viewer.documents["session"]["value"]["state"] == "running", "a STOP in plain text is none"


def test_a_handshake_is_not_waited_for(server):
    """64 clients that say nothing, or only the beginning; they count as connections."""
    half = [plain(server.port) for _ in range(64)]
    for sock in half[1::2]:
        sock.sendall(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03")
    assert status(server.port) == 503
    for sock in half:
        read_all(sock)  # ends when the server closes
        sock.close()
    assert status(server.port) == 200


def test_stop_works_beside_200_connections(server):
    with server.viewer() as viewer:
        opened = [plain(server.port) for _ in range(200)]
        assert request(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"])[0] == "HTTP/1.1 200 OK"
        viewer.until(lambda: viewer.documents.get("session", {}).get("value", {}).get("state") == "stopped")
        for sock in opened:
            sock.close()


def test_a_client_that_ends_one_direction_gets_its_answer(server):
    with plain(server.port) as sock, web_client.TLS.wrap_socket(sock.dup(), server_hostname="localhost") as encrypted:
        encrypted.sendall(f"GET / HTTP/1.1\r\nHost: localhost:{server.port}\r\nConnection: close\r\n\r\n".encode())
        sock.shutdown(socket.SHUT_WR)
        assert read_all(encrypted).startswith(b"HTTP/1.1 200 OK")


def test_a_connection_has_one_handshake(server):
    """s_client asks for another one at the letter R."""
    done = subprocess.run(["openssl", "s_client", "-tls1_2", "-connect", f"127.0.0.1:{server.port}"], input="R\n", capture_output=True,
                          text=True, timeout=WAIT_S)
    assert "RENEGOTIATING" in done.stdout + done.stderr
    assert "no renegotiation" in done.stderr, done.stderr
    assert status(server.port) == 200


def test_junk_in_the_encryption_ends_the_connection(server):
    for length in (1, 5, 100, 20_000):
        with plain(server.port) as sock, web_client.TLS.wrap_socket(sock.dup(), server_hostname="localhost") as encrypted:
            encrypted.sendall(b"GET / HTTP/1.1\r\n")
            sock.sendall(b"\x17\x03\x03\x00\x20" + b"j" * length)
            try:
                assert not encrypted.recv(4096)
            except (ssl.SSLError, ConnectionResetError):
                pass
    assert status(server.port) == 200


def test_the_server_ends_beside_a_handshake(server):
    half = plain(server.port)
    half.sendall(b"\x16\x03\x01")
    viewer = server.viewer()
    assert server.end() == "ended\n"
    assert viewer.until_closed().code == 1001
    half.close()
    server.end = lambda: "ended\n"


run_tests(dict(globals()), NAMES)
