"""A class in which some flood, hang or lie: the others notice nothing, and the teacher's STOP reaches all that can be reached.

Usage: class_faults_test.py SOURCE PROGRAMS [NAME]"""

import errno
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time

from class_program import (LONGEST, ClassProgram, Closed, SeatPage, a_class, copy_of_scenario, encrypted, live, run_tests, runs, school, wait_until)
from search_program import experiment
from web_client import TEXT, Viewer, connect, frame, read_all, request

SEED = random.randrange(2**32)
ATTACKER, OTHER = "127.0.0.5", "127.0.0.6"


def in_threads(count, task):
    """What each of so many threads returned, or its exception."""
    results = [None] * count

    def run(number):
        try:
            results[number] = task(number)
        except Exception as error:  # noqa: BLE001: it is a result
            results[number] = error

    threads = [threading.Thread(target=run, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


def expect_drives(page, times=20):
    """A learner moves a slider, and sees each effect."""
    for number in range(times):
        assert page.must("set", words=[f"amplitude={20 + number % 20}"])["tick"] >= 0
    ticks = page.document("session")["tick"]
    page.viewer.until(lambda: page.document("session")["tick"] > ticks)


def expect_stops(teacher, pages, confirmed=None):
    stopped = teacher.must_stop(*confirmed) if confirmed else teacher.stop()
    for page in pages:
        page.until_state("stopped")
        page.must("run")
        page.until_state("running")
    return stopped


def send_until_full(viewer, data, most=400):
    """Sends until the other end takes no more. Returns how often it was sent."""
    viewer.sock.settimeout(0.3)
    try:
        for number in range(most):
            viewer.sock.sendall(data)
        return most
    except (TimeoutError, BrokenPipeError, ConnectionResetError):
        return number
    finally:
        viewer.sock.settimeout(LONGEST)


# 1. Floods

def test_a_flood_of_operations_slows_nobody(options=()):
    with a_class(4, options) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        with bob.page() as other:
            for way in ("operations", "large", "beats", "stops"):
                message = {"operations": {"type": "operation", "id": 0, "epoch": 1, "name": "ping", "arguments": {}},
                           "large": {"type": "operation", "id": 0, "epoch": 1, "name": "world.paste", "arguments": {"text": "x" * 60_000}},
                           "beats": {"type": "beat", "age_ms": 1}, "stops": {"type": "stop"}}[way]
                viewer = anna.viewer(receive_buffer=4096)
                last = 0
                batch = b""
                for _ in range(2000 if way != "large" else 200):
                    last += 1
                    batch += frame(TEXT, json.dumps({**message, **({"id": last} if "id" in message else {})}).encode())
                thread = threading.Thread(target=send_until_full, args=(viewer, batch, 1), daemon=True)
                thread.start()
                expect_drives(other)
                expect_stops(teacher, [other])
                thread.join()
                viewer.sock.close()
            with anna.page() as page:
                page.must("ping")


def test_who_reads_no_telemetry_slows_nobody():
    with a_class(4) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        deaf = [anna.viewer(receive_buffer=4096) for _ in range(6)]
        for viewer in deaf:
            viewer.send({"type": "subscribe", "signals": ["angle", "head", "torque", "current", "force", "setpoint", "pulse"]})
        deaf[0].until(lambda: "control" in deaf[0].documents)
        with bob.page() as other:
            other.viewer.send({"type": "subscribe", "signals": ["angle", "head"]})
            other.viewer.until(lambda: len(other.viewer.rows) > 100)
            expect_drives(other)
            expect_stops(teacher, [other], (3, 3))
            for viewer in deaf:
                viewer.sock.close()
            with anna.page() as page:
                page.must("run")  # after the STOP
                expect_drives(page)


def test_garbage_ends_only_its_own_connection():
    generator = random.Random(SEED)
    with a_class(4) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        with bob.page() as other:
            for number in range(40):
                path = (f"{anna.path}socket", "/socket", "/robots/0/socket")[number % 3]
                viewer = Viewer(program.port, path=path)
                try:
                    viewer.send_bytes(generator.randbytes(2000))
                except (BrokenPipeError, ConnectionResetError):
                    pass
                viewer.until_closed()
                viewer.sock.close()
                with connect(program.port) as sock:
                    sock.sendall(generator.choice([b"", b"POST /join HTTP/1.1\r\n", b"GET /robots/1/socket HTTP/1.1\r\nUpgrade: websocket\r\n\r\n"]) + generator.randbytes(500) +
                                 b"\r\n\r\n")
            with connect(program.port) as sock:
                early = (f"GET {anna.path}socket HTTP/1.1\r\nHost: 127.0.0.1:{program.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n").encode()
                sock.sendall(early + b"x" * 100)
                assert b" 400 " in read_all(sock).split(b"\r\n")[0], "frames before the answer to the upgrade"
            for key in ("", "x", "A" * 3000, "AAAAAAAAAAAAAAAAAAAAAA==\tX: y"):
                answer = request(program.port, path=f"{anna.path}socket", fields=["Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}",
                                                                                  "Sec-WebSocket-Version: 13"])[0]
                assert answer.split()[1][0] == "4", (key, answer)
            expect_drives(other)
            expect_stops(teacher, [other], (3, 3))
            teacher.until(lambda: teacher.entry(1)["connections"] == 0)


def test_one_computer_takes_only_a_part_of_the_connections(options=()):
    with a_class(4, options) as program, program.teacher() as teacher:
        anna = program.join("Anna")
        with anna.page() as page:
            opened = []
            for number in range(300):
                try:
                    sock = socket.socket()
                    sock.bind((ATTACKER, 0))
                    sock.connect(("127.0.0.1", program.port))
                    if number % 2:
                        sock.sendall(b"GET / HT")
                    opened.append(sock)
                except OSError:
                    pass
            bob = program.join("Bob", source=OTHER)
            with SeatPage(bob, source=OTHER) as other:
                assert other.drives
                expect_drives(other)
                expect_drives(page)
                expect_stops(teacher, [page, other], (3, 3))
            for sock in opened:
                sock.close()
            # Connections to one seat, without a token.
            taken = []
            begin = time.monotonic()
            for _ in range(12):
                try:
                    taken.append(Viewer(program.port, path=f"{bob.path}socket", source=ATTACKER))
                except AssertionError as refused:
                    assert b" 503 " in refused.args[0], refused
            # Each is closed after two seconds without a token.
            assert len(taken) <= 8 or time.monotonic() - begin > 2, len(taken)
            with SeatPage(bob, source=OTHER) as other:
                assert other.drives
            for viewer in taken:
                viewer.until_closed()
                viewer.sock.close()


def test_wrong_codes_of_one_computer_lock_out_no_other():
    with a_class(4) as program:
        anna = program.join("Anna", source=ATTACKER)
        wrong = "000000" if program.code != "000000" else "000001"
        answers = [program.ask_to_join("Eve", code=wrong, source=ATTACKER)[0] for _ in range(200)]
        assert answers == [403] * 10 + [429] * 190, answers
        assert program.ask_to_join("Eve", source=ATTACKER)[0] == 429, "also with the right code"
        assert program.join("Anna", code="", key=anna.key, source=ATTACKER).seat == 1, "a key is not guessed"
        assert program.join("Bob", source=OTHER).seat == 2
        program.not_joined(403, "Carla", code=wrong, source=OTHER)


def test_one_address_has_so_many_names():
    for most, options in ((3, ()), (5, ("--seats-per-address", "5"))):
        with a_class(8, options) as program:
            learners = [program.join(f"L{number}", source=ATTACKER) for number in range(most)]
            error = program.not_joined(503, "Eve", source=ATTACKER)
            assert f"found {most} names" in error and f"expected at most {most}" in error, error
            assert program.join("L0", code="", key=learners[0].key, source=ATTACKER).seat == learners[0].seat
            assert program.join("Bob", source=OTHER).name == "Bob"
            with program.teacher() as teacher:
                teacher.must("remove", seat=learners[0].seat)
            assert program.join("Carla", source=ATTACKER).name == "Carla"


def test_a_learner_has_a_share_of_the_processors():
    """The teacher has none of these limits."""
    with a_class(4) as program:
        anna = program.join("Anna")
        with anna.page() as page:
            wanted = {"experiment": experiment(evaluations="1000000"), "engine": None}
            sweep = {"over": ["amplitude=10:50:0.01"], "measure": "distance", "engine": None, "workers": 1}
            page.must("draft.run", name="duration", value=1)
            page.must("search.refresh")
            page.viewer.until(lambda: "searches" in page.viewer.documents)
            share = max(1, os.cpu_count() // 4)
            assert page.document("searches")["processors"] == share
            error = page.refused("search.start", name="many", workers=1024, **wanted)
            assert f"found 1024, expected 1 to {share}" in error, error
            assert f"expected 1 to {share}" in page.refused("search.estimate", workers=1024, **wanted)
            assert f"expected 1 to {share}" in page.refused("sweep.start", name="many", **{**sweep, "workers": 1024})
            assert not (program.folder / "Anna/searches/many").exists() and not (program.folder / "Anna/sweeps/many").exists()
            page.must("search.start", name="one", workers=None, **wanted)
            for number in range(20):
                error = page.refused("search.start", name=f"more {number}", workers=1, **wanted)
                assert "found 1 searches and sweeps that go on (one), expected fewer than 1" in error, error
            assert "expected fewer than 1" in page.refused("sweep.start", name="more", **sweep)
            assert sorted(path.name for path in (program.folder / "Anna/searches").iterdir()) == ["one"]
            with program.teacher() as teacher:
                teacher.must("restart", seat=anna.seat)
        with anna.page() as page:  # the search goes on without the program that has begun it
            page.must("draft.run", name="duration", value=1)
            assert "(one)" in page.refused("sweep.start", name="more", **sweep)
            page.must("search.stop", name="searches/one")
            wait_until(lambda: page.ask("sweep.start", name="more", **sweep)["ok"], "the sweep does not start after the search")
            page.must("sweep.stop", name="sweeps/more")
        with program.teachers_robot().page() as page:
            page.must("search.refresh")
            page.viewer.until(lambda: "searches" in page.viewer.documents)
            assert page.document("searches")["processors"] == os.cpu_count()


# 2. At the same time

def test_one_of_many_gets_a_name():
    with a_class(4) as program:
        results = in_threads(24, lambda number: program.ask_to_join(("Anna", "ANNA", " anna ")[number % 3]))
        statuses = sorted(status for status, _ in results)
        assert statuses == [200] + [409] * 23, statuses
        results = in_threads(12, lambda number: program.ask_to_join(f"Learner {number}"))
        statuses = sorted(status for status, _ in results)
        assert statuses == [200] * 3 + [503] * 9, statuses
        assert len({answer["seat"] for status, answer in results if status == 200}) == 3
        key = next(answer["key"] for status, answer in results if status == 200)
        name = next(answer["name"] for status, answer in results if status == 200)
        again = in_threads(12, lambda number: program.ask_to_join(name, "", key))
        assert {status for status, _ in again} == {200} and len({answer["token"] for _, answer in again}) == 1


def test_two_teachers_work_at_the_same_time():
    with a_class(8) as program:
        learners = [program.join(f"L{number}") for number in range(3)]
        scenario = copy_of_scenario(program.folder / "Teacher/mine")
        teachers = [program.teacher() for _ in range(2)]

        def work(number):
            teacher = teachers[number]
            for turn in range(8):
                handed = teacher.must("hand_out", file=str(scenario))
                assert len(handed["handed"]) == 3 and not handed["failed"], handed
                teacher.must("collect")
                teacher.must("message", text=f"{number} {turn}")
                teacher.must("lock", locked=bool(turn % 2))
                assert teacher.stop()["of"] >= 1
                teacher.ask("restart", seat=learners[turn % 3].seat)
            return "done"

        assert in_threads(2, work) == ["done"] * 2
        for learner in learners:
            assert len(list((program.folder / learner.name).glob("uniform*/uniform.simulation.xml"))) == 1 + 16
            with learner.page() as page:
                page.must("ping")
        for teacher in teachers:
            teacher.viewer.sock.close()


def test_joins_while_a_teacher_removes():
    with a_class(4) as program:
        teachers = [program.teacher() for _ in range(2)]

        def work(number):
            if number < 2:
                for _ in range(25):
                    teachers[number].ask(("remove", "let_in")[number], seat=1)
            else:
                for _ in range(12):
                    status, answer = program.ask_to_join("Anna")
                    assert status in (200, 409, 503), (status, answer)
                    if status == 200:
                        try:
                            program.status(f"/robots/{answer['seat']}/")
                            Viewer(program.port, path=f"/robots/{answer['seat']}/socket").sock.close()
                        except AssertionError as refused:
                            assert any(word in refused.args[0] for word in (b" 503 ", b" 404 ")), refused
                        except Closed:
                            pass
            return "done"

        assert in_threads(5, work) == ["done"] * 5
        with teachers[0] as teacher:
            teacher.ask("remove", seat=1)
            anna = program.join("Anna")
            with anna.page() as page:
                page.until_state("running")
                teacher.until_seat(anna, lambda entry: entry["connections"] == 1)
                assert len(teacher.document["learners"]) == 1
                expect_stops(teacher, [page], (2, 2))


# 3. Robots that hang

def test_a_seat_that_hangs_holds_up_nobody():
    with a_class(4) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        with anna.page() as stuck, bob.page() as other:
            process = program.seat_process("Anna")
            os.kill(process, signal.SIGSTOP)
            expect_drives(other)
            expect_stops(teacher, [other], (2, 3))
            for number in range(300):
                teacher.must("message", text=f"{number} " + "x" * 190)
            expect_stops(teacher, [other], (2, 3))
            assert program.status(anna.path) == 200
            # Each load of the page leaves connections that the program does not end.
            for _ in range(6):
                with connect(program.port) as sock:
                    sock.sendall(f"GET {anna.path}socket HTTP/1.1\r\nHost: 127.0.0.1:{program.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                 "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
            copy_of_scenario(program.folder / "Teacher/mine")
            handed = teacher.must("hand_out", file=str(program.folder.resolve() / "Teacher/mine/uniform.simulation.xml"))
            assert [entry["seat"] for entry in handed["handed"]] == [1, 2], handed
            teacher.must("collect")
            teacher.must("restart", seat=anna.seat)
            stuck.viewer.until_closed()
            wait_until(lambda: not runs(process))
            with anna.page() as page:
                assert page.drives
                expect_drives(page)
                expect_stops(teacher, [page, other], (3, 3))
                teacher.until_seat(anna, lambda entry: entry["connections"] == 1)


def test_a_seat_that_does_not_start_holds_up_nobody():
    with a_class(4) as program, program.teacher() as teacher:
        bob = program.join("Bob")
        known = set(program.seats())
        answers = []
        thread = threading.Thread(target=lambda: answers.append(program.ask_to_join("Anna")))
        thread.start()
        for process in wait_until(lambda: set(program.seats()) - known, pause_s=0.001):
            os.kill(process, signal.SIGSTOP)
        with bob.page() as other:
            expect_drives(other)
            expect_stops(teacher, [other])
            carla = program.join("Carla")
            thread.join()  # the program is ended after a while
            status, answer = answers[0]
            if status == 503:  # else it was stopped after it had said that it is ready
                # The name is not lost: the browser has no key, so its teacher can let it in.
                teacher.until(lambda: any(entry["name"] == "Anna" for entry in teacher.document["learners"]))
                anna = next(entry for entry in teacher.document["learners"] if entry["name"] == "Anna")
                teacher.must("let_in", seat=anna["seat"])
                program.join("Anna")
            with carla.page() as page:
                page.must("ping")


def test_a_program_that_ends_again_and_again_is_reported():
    with a_class(4) as program, program.teacher() as teacher:
        anna = program.join("Anna")
        for _ in range(4):
            process = wait_until(lambda: program.seat_process("Anna"))
            teacher.until_seat(anna, lambda entry: entry["state"] == "ready")
            wait_until(lambda: can_open(anna))
            os.kill(process, signal.SIGKILL)
            wait_until(lambda: program.seat_process("Anna") != process)
            teacher.must("lock", locked=False)
        teacher.until_seat(anna, lambda entry: entry["state"] == "ended" and "signal 9" in entry["problem"])
        assert program.status(anna.path) == 200
        assert teacher.stop()["of"] == 1, "a program that has ended moves nothing"
        assert program.join("Anna", code="", key=anna.key).token == anna.token, "a person who comes starts it again"
        with anna.page() as page:
            expect_stops(teacher, [page], (2, 2))


def can_open(learner):
    try:
        learner.viewer().sock.close()
        return True
    except AssertionError as refused:
        assert b" 503 " in refused.args[0], refused
    except Closed:
        pass
    return False


# 4. What a teacher's connection may send

def test_random_arguments_are_refused_in_one_line():
    generator = random.Random(SEED)
    names = ["projects", "hand_out", "collect", "message", "lock", "let_in", "restart", "remove", "none", ""]

    def value(depth=0):
        kinds = [None, True, False, 0, 1, -1, 1.5, 2**31, 2**32, 2**32 + 1, 2**53, -2**53, "", "x", "1", "..", "a\0b", "\u202e", "x" * 5000, "/etc/passwd", [], {}, [1], [1, 1], ["1"], [[1]],
                 {"seat": 1}, list(range(2000))]
        if depth < 3 and generator.random() < 0.3:
            return generator.choice([[value(depth + 1) for _ in range(generator.randrange(4))], {generator.choice("ab"): value(depth + 1)}])
        return generator.choice(kinds)

    with a_class(4) as program:
        anna, bob = program.join("Anna"), program.join("Bob")
        with program.teacher() as teacher, bob.page() as other:
            for number in range(600):
                name = generator.choice(names)
                arguments = {word: value() for word in ("seat", "seats", "file", "text", "locked", "x") if generator.random() < 0.6}
                if name in ("remove", "let_in", "restart") and arguments.get("seat") in (1, 2, True):
                    continue
                result = teacher.ask(name, **arguments)
                assert result["ok"] or ("\n" not in result["error"] and 0 < len(result["error"]) < 1000), (SEED, name, arguments, result)
                if number % 100 == 0:
                    expect_drives(other, 3)
            assert [entry["seat"] for entry in teacher.must("hand_out", file=str(copy_of_scenario(program.folder / "Teacher/mine")))["handed"]] == [1, 2]
            program.teachers_robot().page().close()  # it may have been started anew
            expect_stops(teacher, [other], (3, 3))


# 5. Folders

def test_a_folder_that_is_gone_is_one_line():
    with a_class(4) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        scenario = copy_of_scenario(program.folder / "Teacher/mine")
        shutil.rmtree(program.folder / "Anna")
        handed = teacher.must("hand_out", file=str(scenario))
        assert [entry["seat"] for entry in handed["handed"]] == [2] and [entry["seat"] for entry in handed["failed"]] == [1], handed
        assert "\n" not in handed["failed"][0]["error"]
        teacher.must("collect")
        teacher.must("restart", seat=anna.seat)
        with anna.page() as page:
            page.must("ping")
        (program.folder / "Teacher/collected").write_text("not a folder")
        with bob.page() as other:
            other.must("record", file="a.proleg")
            other.must("record", file=None)
            collected = teacher.must("collect")
            assert collected["copied"] == 0 and [entry["seat"] for entry in collected["failed"]] == [2], collected
            moved = program.folder.with_name("moved")
            program.folder.rename(moved)
            program.not_joined(503, "Carla")
            program.not_joined(503, "Carla")
            teacher.refused("hand_out", file=str(scenario))
            expect_drives(other)
            expect_stops(teacher, [other])
            moved.rename(program.folder)
            carla = program.join("Carla")
            assert carla.name == "Carla", "an attempt that failed has not taken the name"


def test_a_full_disk_is_one_line():
    with school() as folder:
        place = folder / "class"
        place.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "none", place], capture_output=True, text=True)
        if mounted.returncode != 0:
            print("   skipped: no tmpfs can be mounted here:", mounted.stderr.strip())
            return
        try:
            with ClassProgram(folder, 4) as program, program.teacher() as teacher:
                anna, bob = program.join("Anna"), program.join("Bob")
                with bob.page() as other:
                    other.must("record", file="a.proleg")
                    other.viewer.until(lambda: other.document("session")["tick"] > 200)
                    other.must("record", file=None)
                    scenario = copy_of_scenario(program.folder / "Teacher/mine")
                    fill(place / "ballast")
                    before = sorted(str(path) for path in place.rglob("*"))
                    handed = teacher.must("hand_out", file=str(scenario))
                    assert handed["handed"] == [] and len(handed["failed"]) == 2, handed
                    assert all("\n" not in entry["error"] for entry in handed["failed"])
                    collected = teacher.must("collect")
                    assert collected["copied"] == 0 and len(collected["failed"]) == 1, collected
                    program.not_joined(503, "Carla")
                    left = [str(path) for path in place.rglob("*") if str(path) not in before and path.is_file() and path.stat().st_size > 0]
                    assert not left, left
                    result = teacher.ask("let_in", seat=anna.seat)
                    assert result["ok"] or "\n" not in result["error"], result
                    expect_stops(teacher, [other])
                    (place / "ballast").unlink()
                    json.loads((place / "class.json").read_text())
                    carla = program.join("Carla")
                    assert carla.name == "Carla", "an attempt that failed has not taken the name"
                    assert len(teacher.must("hand_out", file=str(scenario))["handed"]) == 3
                    assert teacher.must("collect")["copied"] == 1
        finally:
            subprocess.run(["umount", "-l", place], check=True)


def fill(file):
    with open(file, "wb", buffering=0) as ballast:
        for size in (65536, 4096, 1):
            try:
                while True:
                    ballast.write(b"x" * size)
            except OSError as error:
                assert error.errno == errno.ENOSPC, error


# 6. Encrypted

def test_a_class_in_the_network():
    with school() as folder, encrypted(folder) as options, ClassProgram(folder, 4, options) as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        with anna.page() as page, bob.page() as other:
            assert page.drives and other.drives, "also in the network"
            expect_drives(page)
            expect_stops(teacher, [page, other], (3, 3))
            assert program.post(f"{anna.path}stop", fields=[f"Authorization: Bearer {anna.token}"])[0] == 200
            page.until_state("stopped")
            handed = teacher.must("hand_out", file=str(copy_of_scenario(program.folder / "Teacher/mine")))
            assert len(handed["handed"]) == 2
            assert teacher.document["address"].startswith("https://")
        program.end()


def test_a_class_in_the_network_with_floods():
    with school() as folder, encrypted(folder) as options:
        test_a_flood_of_operations_slows_nobody(options)
        test_one_computer_takes_only_a_part_of_the_connections(options)


if __name__ == "__main__":
    print("seed", SEED)
    run_tests(dict(globals()), *sys.argv[3:])
