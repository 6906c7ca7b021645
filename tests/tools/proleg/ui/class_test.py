"""A class: `proleg ui --class` with scripted connections of a teacher and of learners.

Usage: class_test.py SOURCE PROGRAMS [NAME]"""

import json
import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

from class_program import (LONGEST, PROGRAMS, SCENARIO, SOURCE, TITLES, ClassProgram, Closed, Learner, a_class, copy_of_scenario, live, run_tests,
                           runs, school, wait_until)
from web_client import Viewer, request

HIDDEN_CHARACTERS = ("\0", "a\0b", "a\x1b[2J", "a\x08b", "\x7f", "\u202eevil", "a\u200eb", "\u200b", "\u2066x\u2069", "\ufeff", "a\u2028b")


def files_in(folder):
    """The bytes of all files, by path."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


# 1. Paths

def test_each_seat_has_one_path(program_options=()):
    with a_class(2, program_options) as program:
        anna, bob = program.join("Anna"), program.join("Bob")
        assert program.body("/") == TITLES["class.html"]
        for learner in (anna, bob):
            assert program.body(learner.path) == TITLES["index.html"], learner.path
        assert program.body("/robots/0/") == TITLES["index.html"], "the teacher's own robot"
        for path in ("/robots/01/", "/robots/1", "/robots/+1/", "/robots/-1/", "/robots/1x/", "/robots/ 1/", "/robots//", "/robots/", "/robots", "/robots/3/",
                     "/robots/999/", "/robots/4294967297/", "/robots/99999999999999999999/", "/robots/1/../", "/robots/1/../2/", "/robots/1/../../etc/passwd",
                     "/robots/1//", "/robots/1/robots/2/", "/robots/%31/", "/robots/1/%2e%2e/", "/Robots/1/", "/robots/1/missing.js", "/robots/1;/"):
            assert program.status(path) in (404, 400), (path, program.status(path))
        for path in ("/robots/3/socket", "/robots/01/socket"):
            try:
                Viewer(program.port, anna.token, path=path)
                raise AssertionError(f"{path} is a socket")
            except AssertionError as refused:
                assert b" 404 " in refused.args[0], (path, refused)


def test_a_token_opens_one_seat():
    with a_class(2) as program, program.teacher() as teacher:
        anna, bob, own = program.join("Anna"), program.join("Bob"), program.teachers_robot()
        tokens = {"Anna": anna.token, "Bob": bob.token, "own robot": own.token, "teacher": program.token}
        assert len(set(tokens.values())) == 4, "all tokens differ"
        paths = {"Anna": f"{anna.path}socket", "Bob": f"{bob.path}socket", "own robot": "/robots/0/socket", "teacher": "/socket"}
        for whose, token in tokens.items():
            for seat, path in paths.items():
                viewer = Viewer(program.port, path=path)
                viewer.send({"type": "hello", "protocol": 1, "token": token, "name": "x"})
                try:
                    assert viewer.next()["type"] == "welcome" and whose == seat, (whose, seat)
                except Closed as closed:
                    assert whose != seat and closed.code == 1008 and "wrong token" in closed.reason, (whose, seat, closed)
                viewer.sock.close()
                stop = program.post(path.replace("socket", "stop"), fields=[f"Authorization: Bearer {token}"])[0]
                assert stop == (200 if whose == seat else 401), (whose, seat, stop)
        teacher.until(lambda: {anna.seat, bob.seat} <= {entry["seat"] for entry in teacher.document["learners"]})
        for learner in (anna, bob, own):
            assert teacher.entry(learner.seat)["token"] == learner.token and teacher.entry(learner.seat)["path"] == learner.path
        assert program.post(f"{anna.path}stop")[0] == 401, "without a token"
        assert program.post("/robots/7/stop", fields=[f"Authorization: Bearer {program.token}"])[0] in (401, 404)
        assert program.post(f"{anna.path}join", b"{}")[0] in (404, 405)
        for document in ("robot", "session", "telemetry"):
            assert document not in teacher.viewer.documents


# 2. The way in

def test_a_name_and_the_code_give_a_robot():
    with a_class() as program:
        anna = program.join("Anna")
        assert (anna.seat, anna.name, anna.path) == (1, "Anna", "/robots/1/")
        again = program.join("Anna", code="", key=anna.key)
        assert (again.seat, again.token, again.key) == (anna.seat, anna.token, anna.key), "the key is enough"
        assert program.join("anna", code="000", key=anna.key).seat == anna.seat
        assert program.join("  Anna \t ", code="", key=anna.key).name == "Anna"
        for name in ("Anna", "ANNA", "aNNa", " anna  "):
            assert "Anna" in program.not_joined(409, name)
            program.not_joined(409, name, key="A" * 43)
        for code in ("", "000000" if program.code != "000000" else "000001", program.code + "0", f" {program.code}", program.code[:5]):
            assert "teacher" in program.not_joined(403, "Bob", code=code)
        for name in ("Teacher", "teacher", " TEACHER "):
            program.not_joined(409, name)
        bob = program.join("  Bob   the\tsecond ")
        assert bob.name == "Bob the second", bob.name
        with program.teacher() as teacher:
            teacher.until(lambda: [(entry["seat"], entry["name"]) for entry in teacher.document["learners"]] == [(1, "Anna"), (2, "Bob the second")])
            assert teacher.document["limit"] == 6 and teacher.document["code"] == program.code and not teacher.document["is_locked"]
            assert teacher.document["address"] == f"http://127.0.0.1:{program.port}/"
            assert teacher.document["folder"] == str(program.folder.resolve()) and teacher.document["teacher"]["seat"] == 0
        for path in (program.folder / "class.json",):
            assert stat.S_IMODE(path.stat().st_mode) == 0o600, "tokens are secrets"


def test_odd_names_get_a_plain_folder():
    with a_class(12) as program:
        outside = sorted(str(path) for path in program.folder.parent.iterdir())
        names = ("<script>alert(1)</script>", "..", ".", "a/b", "/etc/passwd", "\U0001f41b", "x" * 40, "\u00e9" * 40, "class.json", "-rf", ".class.lock", "a\\b")
        for name in names:
            learner = program.join(name)
            assert learner.name == name, (learner.name, name)
            with learner.page() as page:
                page.viewer.until(lambda: "session" in page.viewer.documents)
                assert page.document("seat") == {"name": name, "is_teacher": False, "has_modules": False}
        folders = [path.name for path in program.folder.iterdir() if path.is_dir()]
        assert len(folders) == len(names) + 1 and not any(name.startswith(".") for name in folders), folders
        assert sorted(str(path) for path in program.folder.parent.iterdir()) == outside, "all is in the folder of the class"


def test_names_that_nobody_sees_are_refused():
    with a_class() as program:
        for name in ("", "   ", "\t", "x" * 41, "\u00e9" * 41, *HIDDEN_CHARACTERS):
            error = program.not_joined(400, name)
            assert len(error) < 400 and error.isprintable(), error
        status, _, _ = program.post("/join", json.dumps({"name": "x" * 10_000, "code": program.code}).encode())
        assert status == 413, status
        program.not_joined(400, "x" * 3000)
        assert [path.name for path in program.folder.iterdir() if path.is_dir()] == ["Teacher"]


def test_a_body_of_another_form_is_refused():
    with a_class() as program:
        code = program.code
        for body in (b"x", b"[]", b"1", b"null", b'"Anna"', b"{", b"[" * 4000, b'{"a":' * 800, b'{"name": "Anna"', b"\xff\xfe", b'{"name": "\\ud800", "code": "1"}',
                     b'{"name": 7}', b'{"name": null, "code": "1"}', b'{"name": ["Anna"], "code": "1"}', b'{"name": {"a": {"b": 1}}}', b"{}",
                     json.dumps({"name": "Anna", "code": int(code)}).encode(), json.dumps({"name": "Anna", "code": [code]}).encode(),
                     json.dumps({"name": "Anna", "code": code, "key": 7}).encode(), json.dumps({"name": "Anna", "code": code, "key": {}}).encode()):
            status, header, content = program.post("/join", body)
            assert status == 400, (body[:60], status)
            assert header["content-type"] == "application/json" and set(json.loads(content)) == {"error"}, content
        assert program.post("/join", b"")[0] == 400
        assert program.post("/join", b"x" * 4097)[0] == 413
        for method in ("GET", "HEAD", "PUT", "DELETE"):
            assert program.status("/join", method) in (404, 405), method
        assert program.post("/join", b"{}", [f"Origin: http://evil.example"])[0] == 403
        assert program.join("Anna").seat == 1, "nothing of this has taken a name"


def test_a_browser_that_has_lost_its_answer_asks_again():
    """With a key that it has made itself."""
    with a_class() as program:
        key = "k" * 42 + "A"
        anna = program.join("Anna", key=key)
        assert anna.key == key
        assert program.join("Anna", key=key).token == anna.token
        program.not_joined(409, "Anna", key="k" * 42 + "E")
        for weak in ("1", "k" * 42, "k" * 44, "k" * 42 + "!", " " + key):
            assert program.join(f"Bob {len(weak)}{weak[-1]}", key=weak).key != weak, "a key that is easy to guess is replaced"


def test_a_full_class_takes_no_name():
    """Who finds no room can come later under the same name."""
    with a_class(2) as program, program.teacher() as teacher:
        program.join("Anna")
        bob = program.join("Bob")
        for _ in range(2):
            assert "full" in program.not_joined(503, "Carla")
        teacher.must("remove", seat=bob.seat)
        carla = program.join("Carla")
        assert carla.name == "Carla"
        with carla.page() as page:
            page.until_state("running")


def test_a_request_for_another_name_is_said_on_the_terminal_once_in_ten_seconds():
    with a_class() as program:
        for number in range(5):
            assert request(program.port, host=f"robot{number}.example")[0].split()[1] == "421"
            assert program.status("/", fields=["Origin: https://robot.example"]) == 403
        program.end()
        lines = [line for line in (program.folder.parent / "errors.txt").read_text().splitlines() if "refused" in line]
        assert lines == [f"proleg ui: warning: a request was refused: Host: found 'robot0.example', expected a name and the port of this page, such as "
                         f"'127.0.0.1:{program.port}'; behind a reverse proxy see docs/reverse-proxy.md"], lines


def test_the_folder_of_a_new_class_is_made():
    with school() as folder:
        page = folder / "page"
        page.mkdir()
        for name, text in TITLES.items():
            (page / name).write_text(text)
        (folder / "taken").write_text("no scenario")
        (folder / "link").symlink_to("nowhere")

        def start(word):
            return subprocess.Popen([PROGRAMS / "proleg", "ui", word, "--class", "2", "--no-browser", "--page", page], cwd=folder, text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE)

        for word in ("friday", "a/b/friday", "monday/", "our friday", "./tuesday", str(folder / "absolute"), "friday", "class 7.b", "Łódź"):
            process = start(word)
            assert process.stdout.readline().startswith("teacher: "), (word, process.communicate())
            process.stdout.readline()
            assert process.stdout.readline() == f"folder: {(folder / word).resolve()}\n", word
            assert (folder / word / "class.json").is_file() and (folder / word / "Teacher").is_dir(), word
            process.send_signal(signal.SIGINT)
            assert process.wait() == 0
        before = sorted(path.name for path in folder.iterdir())
        for word, text in (("taken", "taken"), ("taken/friday", "taken"), ("link", "link"), ("caterpilar", "did you mean caterpillar?"),
                           ("missing.simulation.xml", "missing.simulation.xml"), ("missing.proleg", "missing.proleg")):
            process = start(word)
            _, errors = process.communicate()
            assert process.returncode == 2 and text in errors and errors.count("\n") == 1, (word, process.returncode, errors)
        assert sorted(path.name for path in folder.iterdir()) == before


def test_a_locked_class_takes_nobody_new():
    with a_class() as program, program.teacher() as teacher:
        anna = program.join("Anna")
        teacher.must("lock", locked=True)
        teacher.until(lambda: teacher.document["is_locked"])
        assert "locked" in program.not_joined(409, "Bob")
        assert program.join("Anna", code="", key=anna.key).seat == anna.seat
        teacher.must("lock", locked=False)
        teacher.until(lambda: not teacher.document["is_locked"])
        assert program.join("Bob").seat == 2
        for locked in (None, 1, "true", []):
            teacher.refused("lock", locked=locked)


# 3. The robot of a learner

def test_each_learner_drives_a_robot_of_its_own():
    with a_class() as program:
        with program.join("Anna").page() as anna, program.join("Bob").page() as bob:
            assert anna.drives and bob.drives
            before = bob.amplitudes()
            tick = anna.must("set", words=["amplitude=11"])["tick"]
            assert tick >= 0
            anna.viewer.until(lambda: anna.amplitudes() != before)
            bob.must("ping")
            assert bob.amplitudes() == before, "a robot has parameters of its own"
            bob.must("pause")
            bob.until_state("paused")
            anna.must("ping")
            assert anna.document("session")["state"] == "running"
            for page in (anna, bob):
                page.viewer.send({"type": "subscribe", "signals": ["angle", "head"]})
            anna.viewer.until(lambda: len(anna.viewer.rows) > 3)
            assert len(anna.viewer.rows[0]["values"][0]) == 5 + 7
            assert anna.document("seat") == {"name": "Anna", "is_teacher": False, "has_modules": False}
        with program.teachers_robot().page() as own:
            assert own.document("seat") == {"name": "Teacher", "is_teacher": True, "has_modules": True}


def test_a_reload_and_a_sleep_drive_again():
    with a_class() as program:
        anna = program.join("Anna")
        with anna.page() as first:
            assert first.drives
        with anna.page() as second:
            assert second.drives, "after a reload"
            lives = live(second.viewer)
            with anna.page() as guest:
                assert not guest.drives, "the holder was here a moment ago"
                # A laptop that sleeps: its connection is open, and it says nothing.
                lives.clear()
                guest.viewer.until(lambda: guest.viewer.control()["away"])
            with anna.page() as third:
                assert third.drives, "after a sleep"
                third.must("set", words=["amplitude=12"])
                second.viewer.until(lambda: not second.drives)
                second.refused("set", words=["amplitude=13"])


def test_a_teacher_who_looks_on_takes_nothing():
    with a_class() as program, program.teacher() as teacher:
        anna = program.join("Anna")
        with anna.viewer(look=True) as look:
            look.until(lambda: {"control", "session"} <= set(look.documents))
            assert look.control()["holder"] is None
            with anna.page() as page:
                assert page.drives
                teacher.until_seat(anna, lambda entry: entry["connections"] == 1)
                with anna.viewer(only="stop"):
                    teacher.until_seat(anna, lambda entry: entry["connections"] == 2)
                teacher.until_seat(anna, lambda entry: entry["connections"] == 1)
                look.until(lambda: look.control()["holder"] is not None)
                assert look.control()["holder"]["name"] == "Anna"
                assert "control is with Anna" in look.do("set", 1, words=["amplitude=1"])["error"]
            look.until(lambda: look.control()["holder"] is None)
            teacher.until_seat(anna, lambda entry: entry["connections"] == 0)
            look.do("ping")


def test_stop_of_a_seat_needs_its_token():
    with a_class() as program:
        anna, bob = program.join("Anna"), program.join("Bob")
        with anna.page() as page, bob.page() as other:
            page.until_state("running")
            for token in (bob.token, program.token, "", anna.token[:-1]):
                assert program.post(f"{anna.path}stop", fields=[f"Authorization: Bearer {token}"])[0] == 401
            page.must("ping")
            assert page.document("session")["state"] == "running"
            assert program.post(f"{anna.path}stop", fields=[f"Authorization: Bearer {anna.token}"])[0] == 200
            page.until_state("stopped")
            other.must("ping")
            assert other.document("session")["state"] == "running"
            page.must("run")
            page.until_state("running")
            page.viewer.send({"type": "stop"})
            page.until_state("stopped")
            assert page.viewer.stops or page.must("ping") is None


def test_stop_of_the_teacher_reaches_all_robots():
    with a_class() as program, program.teacher() as teacher:
        learners = [program.join(name) for name in ("Anna", "Bob", "Carla")]
        pages = [learner.page() for learner in (*learners, program.teachers_robot())]
        for way in ("message", "POST"):
            for page in pages:
                page.must("run")
                page.until_state("running")
            if way == "message":
                teacher.must_stop(4, 4)
            else:
                assert program.post("/stop", fields=[f"Authorization: Bearer {program.token}"])[0] == 200
            for page in pages:
                page.until_state("stopped")
        assert program.post("/stop", fields=["Authorization: Bearer x"])[0] == 401
        for page in pages:
            page.close()


def test_a_learner_reaches_nothing_but_its_own():
    with a_class() as program:
        anna, bob = program.join("Anna"), program.join("Bob")
        with bob.page() as page:
            page.must("record", file="bobs.proleg")
            page.must("record", file=None)
            page.must("draft.save_as", folder="bobs world")
        scenario = next((program.folder / "Bob").rglob("bobs world/*.simulation.xml"))
        inside = next((program.folder / "Anna").rglob("*.simulation.xml")).relative_to(program.folder / "Anna")
        before = files_in(program.folder)
        with anna.page() as page:
            for name in ("look", "open", "scan", "assign", "flash", "close"):
                error = page.refused(f"modules.{name}", bus="tcp:127.0.0.1:1")
                assert name == "close" or "teacher" in error, (name, error)
            for name, arguments in (("algorithm.new", {"name": "mine"}), ("algorithm.write", {"folder": "mine", "text": "x"}), ("algorithm.build", {"folder": "mine"}),
                                    ("algorithm.save", {"folder": "mine", "text": "x"})):
                page.refused(name, **arguments)
            other = str(scenario.relative_to(program.folder))
            for file in (f"../{other}", f"../Anna/../{other}", str(scenario), "../class.json", f"./../{other}", "/etc/passwd", "", ".", "..", "a\0b"):
                page.refused("draft.open", file=file, discard=True)
                page.refused("draft.take", file=file, parts=["environment"])
            for file in ("../Bob/bobs.proleg", str(program.folder / "Bob/bobs.proleg"), "../class.json", "..", "bobs.proleg", "./../Bob/bobs.proleg"):
                page.refused("recording.open", file=file)
                page.refused("recording.rows", file=file, signals=["angle"], **{"from": 0, "to": 5, "points": 10})
                page.refused("recording.compare", file=file, **{"with": file})
                page.refused("continue", file=file, tick=0)
            for file in ("../mine.proleg", "../Bob/mine.proleg", str(program.folder / "Bob/mine.proleg"), "/tmp/mine.proleg"):
                page.refused("record", file=file)
            for folder in ("..", "../Bob/x", "/tmp/x", "a/b", ".hidden", ""):
                page.refused("draft.save_as", folder=folder)
                page.refused("file.save_as", folder=folder)
                page.refused("search.start", name=folder, file="cma_es.optimise.xml")
            for name in ("class.projects", "class.remove", "class.hand_out", "class.none"):
                page.refused(name, seat=bob.seat)
            page.must("gallery.look")
            page.viewer.until(lambda: page.viewer.documents.get("gallery", {}).get("value", {}).get("entries"))
            files = [entry["file"] for entry in page.document("gallery")["entries"] if not entry["is_shipped"]]
            assert any(Path(file) == inside for file in files), files
            assert not any("Bob" in file or ".." in file for file in files), files
            listed = page.must("recording.list")["files"]
            assert listed == [], listed
            page.must("draft.open", file=next(file for file in files if Path(file) == inside), discard=True)
            told = json.dumps({name: document["value"] for name, document in page.viewer.documents.items() if name not in ("gallery", "robot")})
            for secret in (bob.token, bob.key, program.token, program.code, "Bob"):
                assert secret not in told, secret
        assert files_in(program.folder).keys() == before.keys()


# 4. What a teacher does

def test_a_teacher_hands_out_files():
    with a_class() as program, program.teacher() as teacher:
        copy_of_scenario(program.folder / "Teacher/stairs")
        (program.folder / "Teacher/outside").mkdir()
        learners = [program.join(name) for name in ("Anna", "Bob")]
        pages = [learner.page() for learner in learners]
        projects = teacher.must("projects")["projects"]
        assert [entry["file"] for entry in projects if entry["group"] == "My project"], projects
        own = next(entry["file"] for entry in projects if entry["file"].endswith("stairs/uniform.simulation.xml"))
        shipped = next(entry["file"] for entry in projects if entry["file"] not in own and entry["group"] != "My project")
        (program.folder / "Anna/uniform.txt").write_text("of the learner")
        before = {name: files_in(program.folder / name) for name in ("Anna", "Bob")}
        for number in (1, 2):
            handed = teacher.must("hand_out", file=own)
            assert handed["failed"] == [] and [entry["seat"] for entry in handed["handed"]] == [1, 2], handed
            for learner, page, entry in zip(learners, pages, handed["handed"]):
                copy = program.folder / learner.name / entry["file"]
                for name in ("uniform.simulation.xml", "caterpillar.robot.xml", "uniform.actuation.xml", "flat.environment.xml"):
                    found = next(copy.parent.rglob(name), None) or next(copy.parent.parent.rglob(name))
                    assert found.read_bytes() == next(Path(own).parent.rglob(name)).read_bytes(), name
                page.viewer.until(lambda: len(page.document("handed_out")) == number)
                assert page.document("handed_out")[-1] == {"number": number, "file": entry["file"], "title": "uniform"}
                page.must("draft.open", file=entry["file"], discard=True)
        for name, files in before.items():
            now = files_in(program.folder / name)
            assert {path: now[path] for path in files if not path.startswith(".")} == {
                path: content for path, content in files.items() if not path.startswith(".")}, "nothing is overwritten"
        handed = teacher.must("hand_out", file=shipped, seats=[2])
        assert [entry["seat"] for entry in handed["handed"]] == [2], handed
        pages[1].viewer.until(lambda: len(pages[1].document("handed_out")) == 3)
        pages[0].must("ping")
        assert len(pages[0].document("handed_out")) == 2
        count = len(files_in(program.folder))
        for file in ("", "none.simulation.xml", "/etc/passwd", "../class.json", f"{Path(own).parent}/../../class.json", str(program.folder / "Anna/uniform/uniform.simulation.xml"),
                     f"{Path(own).parent}/../../Anna/uniform/uniform.simulation.xml", "..", "a\0b", str(program.folder / "Teacher")):
            teacher.refused("hand_out", file=file)
        for seats in ([7], [0], [-1], ["1"], [1.5], "1", {}, [1, 7], [2**40]):
            teacher.refused("hand_out", file=own, seats=seats)
            teacher.refused("collect", seats=seats)
        teacher.refused("hand_out")
        assert teacher.must("hand_out", file=own, seats=[])["handed"] == []
        assert len(files_in(program.folder)) == count, "a refusal has left a file"
        late = program.join("Late")
        assert [entry["seat"] for entry in teacher.must("hand_out", file=own, seats=[late.seat, late.seat])["handed"]] == [late.seat]
        for _ in range(22):
            teacher.must("hand_out", file=own, seats=[late.seat])
        with late.page() as page:
            page.viewer.until(lambda: len(page.document("handed_out")) == 20 and page.document("handed_out")[-1]["number"] == 23)
            assert [entry["number"] for entry in page.document("handed_out")] == list(range(4, 24)), "oldest first, at most 20"
        for page in pages:
            page.close()


def test_a_teacher_collects_finished_recordings():
    with a_class() as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        with anna.page() as page, bob.page() as other:
            for number in (1, 2):
                page.must("record", file=f"run {number}.proleg")
                page.must("pause")
                page.must("step", ticks=50)
                page.must("record", file=None)
            other.must("record", file="run 1.proleg")
            teacher.until_seat(anna, lambda entry: entry["recordings"] == 2)
            teacher.until_seat(bob, lambda entry: entry["recordings"] == 1)
            (program.folder / "Bob/junk.proleg").write_text("no recording")
            os.symlink(program.folder / "class.json", program.folder / "Bob/link.proleg")
            os.symlink(program.folder / "Anna", program.folder / "Bob/annas")
            found = teacher.must("collect")
            assert found == {"copied": 2, "known": 0, "running": 2, "failed": []}, found
            collected = program.folder / "Teacher/collected"
            for number in (1, 2):
                name = f"run {number}.proleg"
                assert (collected / "Anna" / name).read_bytes() == (program.folder / "Anna" / name).read_bytes()
            assert sorted(path.name for path in collected.rglob("*") if path.is_file()) == ["run 1.proleg", "run 2.proleg"]
            other.must("record", file=None)
            assert teacher.must("collect") == {"copied": 1, "known": 2, "running": 1, "failed": []}
            assert teacher.must("collect", seats=[anna.seat]) == {"copied": 0, "known": 2, "running": 0, "failed": []}
            assert teacher.must("collect", seats=[]) == {"copied": 0, "known": 0, "running": 0, "failed": []}
        with program.teachers_robot().page() as own:
            names = [entry["name"] for entry in own.must("recording.list")["files"]]
            assert sorted(names) == ["collected/Anna/run 1.proleg", "collected/Anna/run 2.proleg", "collected/Bob/run 1.proleg"], names
            own.must("recording.open", file="collected/Anna/run 1.proleg")


def test_a_teacher_writes_to_learners():
    with a_class() as program, program.teacher() as teacher:
        with program.join("Anna").page() as anna, program.join("Bob").page() as bob:
            teacher.must("message", text="Look at the board")
            for page in (anna, bob):
                page.viewer.until(lambda: any("Look at the board" in text for text in page.viewer.notices))
            teacher.must("message", text="<b>Anna</b>\n\u202eonly", seats=[1])
            anna.viewer.until(lambda: any("<b>Anna</b>" in text for text in anna.viewer.notices))
            assert all("\n" not in text for text in anna.viewer.notices)
            bob.must("ping")
            assert not any("<b>" in text for text in bob.viewer.notices)
            teacher.must("message", text="x" * 200)
            teacher.must("message", text="\u00e9" * 200)
            for text in ("", "   ", "x" * 201, "\u00e9" * 201, "x" * 10_000, None, 7, ["x"]):
                teacher.refused("message", text=text)
            for seats in ("1", [-1], ["x"]):
                teacher.refused("message", text="x", seats=seats)


def test_another_browser_is_let_in_once():
    with a_class() as program, program.teacher() as teacher:
        anna = program.join("Anna")
        page = anna.page()
        (program.folder / "Anna/mine.txt").write_text("mine")
        teacher.must("let_in", seat=anna.seat)
        page.viewer.until_closed()
        page.close()
        program.not_joined(403, "Anna", code="", key=anna.key)
        program.not_joined(403, "Anna", code="1", key=anna.key)
        again = program.join("anna")
        assert again.seat == anna.seat and again.name == "Anna", "the name and the seat stay"
        assert again.key != anna.key and again.token != anna.token
        assert (program.folder / "Anna/mine.txt").exists() and again.seat == 1
        with again.page() as new:
            assert new.drives
        with Viewer(program.port, path=f"{anna.path}socket") as old:
            old.send({"type": "hello", "protocol": 1, "token": anna.token, "name": "x"})
            assert "wrong token" in old.until_closed().reason
        program.not_joined(409, "Anna")
        program.not_joined(403, "Anna", code="", key=anna.key)
        assert program.join("Anna", code="", key=again.key).token == again.token
        for seat in (0, 7, -1, "1", None, 1.5):
            for name in ("let_in", "remove"):
                teacher.refused(name, seat=seat)
        for seat in (7, -1, "1", None):
            teacher.refused("restart", seat=seat)


def test_a_teacher_restarts_and_removes():
    with a_class() as program, program.teacher() as teacher:
        anna, bob = program.join("Anna"), program.join("Bob")
        page = anna.page()
        process = program.seat_process("Anna")
        teacher.must("restart", seat=anna.seat)
        page.viewer.until_closed()
        page.close()
        teacher.until_seat(anna, lambda entry: entry["state"] == "ready")
        with anna.page() as page:
            assert page.drives, "the token stays"
            wait_until(lambda: not runs(process))
            page.must("draft.save_as", folder="mine")
        with bob.page() as other:
            other.must("ping")
        page = anna.page()
        process = program.seat_process("Anna")
        teacher.must("remove", seat=anna.seat)
        teacher.until(lambda: teacher.entry(anna.seat) is None)
        page.viewer.until_closed()
        page.close()
        wait_until(lambda: not runs(process))
        assert program.status(anna.path) == 404
        assert (program.folder / "Anna/mine").is_dir(), "the folder stays"
        program.not_joined(403, "Anna", code="", key=anna.key)
        new = program.join("Anna")
        assert new.seat == 1 and new.token != anna.token and new.key != anna.key
        assert not (program.folder / "Anna 2/mine").exists() and (program.folder / "Anna 2").is_dir(), "a folder of its own"
        teacher.must("restart", seat=0)
        teacher.until(lambda: teacher.document["teacher"]["state"] == "ready")


def test_a_new_learner_in_an_old_seat_is_present():
    """The end of the connections of the one before does not count."""
    with a_class() as program, program.teacher() as teacher:
        anna = program.join("Anna")
        old = [anna.viewer() for _ in range(3)]
        teacher.until_seat(anna, lambda entry: entry["connections"] == 3)
        process = program.seat_process("Anna")
        os.kill(process, signal.SIGSTOP)  # so that its connections end late
        teacher.must("remove", seat=1)
        bob = program.join("Bob")
        assert bob.seat == 1
        with bob.page(), bob.viewer(only="stop"):
            teacher.until_seat(bob, lambda entry: entry["name"] == "Bob" and entry["connections"] == 2)
            wait_until(lambda: not runs(process))
            for viewer in old:
                viewer.until_closed()
                viewer.sock.close()
            for number in range(20):
                is_locked = number % 2 == 0
                teacher.must("lock", locked=is_locked)
                teacher.until(lambda: teacher.document["is_locked"] == is_locked)
                assert teacher.entry(1)["connections"] == 2, teacher.entry(1)
                time.sleep(0.05)


# 5. Ends

def test_a_program_that_was_killed_starts_again():
    with a_class() as program, program.teacher() as teacher:
        anna = program.join("Anna")
        page = anna.page()
        process = program.seat_process("Anna")
        os.kill(process, signal.SIGKILL)
        page.viewer.until_closed()
        page.close()
        wait_until(lambda: program.seat_process("Anna") not in (None, process))
        teacher.until_seat(anna, lambda entry: entry["state"] == "ready")
        teacher.until(lambda: any("Anna" in text and "signal 9" in text for text in teacher.viewer.notices))
        with anna.page() as page:
            assert page.drives
            page.until_state("paused")
        process = program.seat_process("Teacher")
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: program.seat_process("Teacher") not in (None, process))


def test_a_class_goes_on_after_its_end():
    with school() as folder:
        with ClassProgram(folder, 3) as program:
            anna, bob = program.join("Anna"), program.join("Bob")
            with program.teacher() as teacher:
                teacher.must("let_in", seat=bob.seat)
            code, port, token = program.code, program.port, program.token
            assert program.end() == 0
            program.start(port)
            assert program.code == code and program.port == port and program.token != token
            # A page that was open asks for its files and its socket until it has them.
            assert program.status(anna.path) == 200
            with anna.page() as again:
                assert again.drives
            assert program.join("Anna", code="", key=anna.key).token == anna.token
            program.not_joined(409, "Anna")
            assert program.join("Bob").seat == bob.seat, "who was let in may come once"
            assert program.end(signal.SIGKILL) == -signal.SIGKILL
            program.start(port)
            assert program.join("Anna", code="", key=anna.key).token == anna.token


def test_a_teacher_lets_in_who_came_in_an_earlier_lesson():
    """Also before this learner has come today."""
    with school() as folder, ClassProgram(folder, 3) as program:
        anna = program.join("Anna")
        assert program.end() == 0
        program.start()
        with program.teacher() as teacher:
            program.not_joined(409, "Anna")
            teacher.until(lambda: any(entry["name"] == "Anna" for entry in teacher.document["learners"]))
            entry = teacher.entry(anna.seat)
            assert entry["state"] == "ended" and entry["connections"] == 0, entry
            teacher.must("let_in", seat=entry["seat"])
            again = program.join("Anna")
            assert again.seat == anna.seat and again.key != anna.key


def test_all_programs_end_with_the_class():
    for end, status in ((signal.SIGINT, 0), (signal.SIGTERM, 0), (signal.SIGKILL, -signal.SIGKILL)):
        with school() as folder, ClassProgram(folder, 3) as program:
            anna = program.join("Anna")
            program.join("Bob")
            with anna.page() as page:
                assert len(program.seats()) == 3
                assert program.end(end) == status, end
                page.viewer.until_closed()


def test_a_class_ends_while_somebody_joins():
    """Also while a program of a seat does not start."""
    with school() as folder, ClassProgram(folder, 3) as program:
        known = set(program.seats())
        wish = json.dumps({"name": "Anna", "code": program.code}).encode()
        from web_client import connect, read_all
        with connect(program.port) as sock:
            sock.sendall(f"POST /join HTTP/1.1\r\nHost: 127.0.0.1:{program.port}\r\nContent-Length: {len(wish)}\r\n\r\n".encode() + wish)
            started = wait_until(lambda: set(program.seats()) - known, pause_s=0.001)
            for process in started:
                os.kill(process, signal.SIGSTOP)
            assert program.end() == 0
            read_all(sock)


# 6. Bad input

def refused_start(*words, folder):
    environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state"), "XDG_RUNTIME_DIR": str(folder)}
    done = subprocess.run([PROGRAMS / "proleg", "ui", *map(str, words), "--no-browser", "--page", folder / "page"], capture_output=True, text=True,
                          timeout=60, cwd=folder, env=environment)
    assert done.returncode == 2, (words, done)
    assert done.stderr.count("\n") == 1 and done.stderr.endswith("\n") and not done.stdout, (words, done)
    return done.stderr


def test_bad_options_are_one_line():
    with school() as folder:
        (folder / "page").mkdir()
        for name, text in TITLES.items():
            (folder / "page" / name).write_text(text)
        for word in ("0", "x", "-1", "101", "1.5", "12x", "", "99999999999"):
            assert "--class" in refused_start(f"--class={word}", SCENARIO, folder=folder), word
        for options in (("--bus", "tcp:127.0.0.1:1"), ("--paused",), ("--seat",), ("--set", "amplitude=3"), ("--seed", "3"), ("--engine", "ode")):
            refused_start("--class", "12", SCENARIO, *options, folder=folder)
        assert "--certificate" in refused_start("--class", "12", "--lan", folder=folder)
        refused_start("--class", "2", "--port", "99999", SCENARIO, folder=folder)
        refused_start("--class", "2", folder / "none.simulation.xml", folder=folder)
        broken = folder / "broken.simulation.xml"
        broken.write_text("<simulation>")
        refused_start("--class", "2", broken, folder=folder)
        file = folder / "file"
        file.write_text("x")
        refused_start("--class", "2", SCENARIO, "--recordings", file, folder=folder)
        assert not (folder / "class").exists(), "a refusal has begun a class"


def test_a_class_is_open_once():
    with a_class() as program:
        error = refused_start("--class", "3", program.folder, folder=program.folder.parent)
        assert "another program" in error, error
        assert program.join("Anna").seat == 1


def test_a_damaged_class_is_one_line():
    with school() as folder:
        with ClassProgram(folder) as program:
            program.join("Anna")
            program.end()
        file = program.folder / "class.json"
        whole = file.read_text()
        value = json.loads(whole)

        def changed(**changes):
            return json.dumps({**value, **changes})

        def learner(**changes):
            return changed(learners=[{**value["learners"][1], **changes}])

        for text in ("", "x", "[]", "null", whole[:len(whole) // 2], "\0" * 100, "[" * 100_000, changed(version=2), changed(version="1"), changed(code=7), changed(code="12345"),
                     changed(code="12345x"), changed(learners={"a": 1}), changed(learners=7), changed(learners=[7]), changed(learners=[[]]), learner(folder=".."), learner(folder="a/b"),
                     learner(folder=""), learner(folder="/tmp"), learner(folder="."), learner(token="x"), learner(token=7), learner(seat=-1), learner(seat=10_000), learner(seat="1"),
                     learner(name="a\nb"), learner(name=""), learner(name="x" * 1000), learner(key=7), learner(key=""), learner(is_let_in="x"), learner(seat=1.5), learner(seat=2**32 + 1),
                     learner(seat=True), learner(folder=".x"), learner(folder="a\0b"), changed(learners=None), changed(learners={}), changed(learners=[value["learners"][1]] * 2),
                     changed(learners=[value["learners"][1], {**value["learners"][1], "seat": 2}])):
            file.write_text(text)
            error = refused_start("--class", "3", program.folder, folder=folder)
            assert "class.json" in error, (text[:80], error)
            assert file.read_text() == text, "the file stays as it is"
        file.unlink()
        file.mkdir()
        refused_start("--class", "3", program.folder, folder=folder)
        file.rmdir()
        file.write_text(whole)
        with ClassProgram(folder, scenario=None) as again:
            assert again.code == value["code"]


if __name__ == "__main__":
    run_tests(dict(globals()), *sys.argv[3:])
