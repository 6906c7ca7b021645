"""Figures of a class on one computer: a robot and a slider for each learner, a teacher who looks on, then one who floods, one
robot that hangs and one that computes as fast as it can; how long the teacher's STOP takes. It asserts nothing.

Usage: class_figures.py SOURCE PROGRAMS [--learners 12] [--seconds 10] [--json]"""

import argparse
import json
import multiprocessing
import os
import signal
import sys
import threading
import time
from pathlib import Path

from class_program import Closed, ClassProgram, Viewer, live, school
from web_client import TEXT, frame

SLIDER_HZ = 60
SLIDER_LIMIT_MS = 60
STOP_LIMIT_MS = 100
STOP_TRIALS = 20
REAL_TIME = 0.99


def percentile(values, part):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))] if ordered else None


def processor_seconds(process):
    words = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def resident_mb(process):
    words = Path(f"/proc/{process}/statm").read_text().split()
    return int(words[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


class Slider:
    """A learner with a page: telemetry at full rate, beats, and a slider that is moved all the time."""

    def __init__(self, port, path, token, name):
        self.viewer = Viewer(port, token, name, path=f"{path}socket", wants_control=True)
        self.viewer.until(lambda: {"control", "session", "telemetry"} <= set(self.viewer.documents))
        live(self.viewer)
        self.viewer.send({"type": "subscribe", "signals": ["angle", "head"]})
        self.moves = threading.Event()
        self.ends = False
        self.sent = {}
        self.ms = []
        self.factors = []
        self.times = []  # (time, simulated time)
        self.states = []  # (time, state)
        self.rows = 0
        threading.Thread(target=self.move, daemon=True).start()

    def move(self):
        number, next_at = 0, time.monotonic()
        while not self.ends:
            if not self.moves.wait(0.1):
                next_at = time.monotonic()
                continue
            number += 1
            self.sent[self.viewer.last_id + 1] = time.monotonic()
            try:
                self.viewer.start("set", self.viewer.control()["epoch"], words=[f"amplitude={10 + number % 60 / 2}"], gesture=1)
            except OSError:
                return
            next_at += 1 / SLIDER_HZ
            time.sleep(max(0, next_at - time.monotonic()))

    def read(self):
        """Until the connection ends."""
        while True:
            message = self.viewer.next()
            now = time.monotonic()
            kind = message["type"]
            if kind == "result":
                began = self.sent.pop(message["id"], None)
                if began is not None:
                    self.ms.append((now - began) * 1000)
                self.viewer.results.clear()
            elif kind == "rows":
                self.rows += len(message["values"])
                self.viewer.rows.clear()
            elif kind == "document" and message["name"] == "session":
                self.factors.append(message["value"]["measured_factor"])
                self.times.append((now, message["value"]["time_s"]))
                if not self.states or self.states[-1][1] != message["value"]["state"]:
                    self.states.append((now, message["value"]["state"]))


def learner_process(pipe, port, path, token, name):
    """One learner in a process of its own, so that none waits for the interpreter of another. It takes words from the pipe."""
    slider = Slider(port, path, token, name)

    def read():
        try:
            slider.read()
        except (Closed, OSError):
            pass

    threading.Thread(target=read, daemon=True).start()
    pipe.send("ready")
    while True:
        word = pipe.recv()
        if word == "begin":
            slider.ms, slider.factors, slider.times, slider.rows, slider.began = [], [], [], 0, time.monotonic()
            slider.sent.clear()
            slider.moves.set()
        elif word == "report":
            slider.moves.clear()
            seconds = time.monotonic() - slider.began
            (first, simulated), (last, simulated_last) = slider.times[0], slider.times[-1]
            pipe.send({"ms": slider.ms, "rate": (simulated_last - simulated) / (last - first) if last > first else 0, "factors": [factor for factor in slider.factors if factor is not None],
                       "rows_per_second": slider.rows / seconds, "unanswered": len(slider.sent)})
        elif word == "stopped":  # when the robot was seen to stop; the clock is that of all processes
            pipe.send(slider.states[-1] if slider.states else None)
        elif word == "run":
            slider.viewer.start("run", slider.viewer.control()["epoch"])
        elif word == "end":
            slider.ends = True
            return
        elif isinstance(word, dict):
            slider.viewer.start(word.pop("name"), slider.viewer.control()["epoch"], **word)


class Person:
    def __init__(self, program, name):
        self.learner = program.join(name)
        self.pipe, other = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=learner_process, args=(other, program.port, self.learner.path, self.learner.token, name), daemon=True)
        self.process.start()
        assert self.pipe.recv() == "ready"

    def tell(self, word):
        self.pipe.send(word)

    def ask(self, word):
        self.pipe.send(word)
        return self.pipe.recv()


def look_on(program, learners, ends):
    """A teacher's page with all robots; read in one process, which is not the class's."""
    import selectors
    selector = selectors.DefaultSelector()
    for learner in learners:
        viewer = learner.viewer(look=True)
        viewer.until(lambda: "telemetry" in viewer.documents)
        viewer.send({"type": "subscribe", "signals": ["angle", "head"]})
        selector.register(viewer.sock, selectors.EVENT_READ)
    while not ends.is_set():
        for key, _ in selector.select(0.2):
            if not key.fileobj.recv(1 << 16):
                selector.unregister(key.fileobj)


def measure(people, processes, seconds):
    """Of all who move a slider; processor and memory of the programs."""
    before = {name: sum(map(processor_seconds, group)) for name, group in processes.items()}
    begin = time.monotonic()
    for person in people:
        person.tell("begin")
    time.sleep(seconds)
    passed = time.monotonic() - begin
    used = {name: (sum(map(processor_seconds, group)) - before[name]) / passed * 100 for name, group in processes.items()}
    reports = [person.ask("report") for person in people]
    ms = [value for report in reports for value in report["ms"]]
    factors = [percentile(report["factors"], 0.5) for report in reports if report["factors"]]
    rates = [report["rate"] for report in reports]
    return {"answers": len(ms), "expected": round(len(people) * SLIDER_HZ * passed), "unanswered": sum(report["unanswered"] for report in reports),
            "p50_ms": percentile(ms, 0.5), "p99_ms": percentile(ms, 0.99), "worst_ms": max(ms, default=None),
            "worst_p99_ms_of_a_learner": max((percentile(report["ms"], 0.99) or 0 for report in reports), default=None),
            "lowest_rate": min(rates, default=None), "rates": [round(rate, 3) for rate in rates], "median_measured_factors": [round(factor, 3) for factor in factors],
            "rows_per_second": [round(report["rows_per_second"]) for report in reports],
            "processor_percent": {name: round(value, 1) for name, value in used.items()},
            "memory_mb": {name: round(sum(map(resident_mb, group)), 1) for name, group in processes.items()}}


def flood(learner, ends):
    """A program that sends operations without end and reads nothing, and comes back when its connection is ended."""
    while not ends.is_set():
        try:
            viewer = learner.viewer(receive_buffer=4096)
            viewer.sock.settimeout(1)
            number = 0
            while not ends.is_set():
                batch = b""
                for _ in range(500):
                    number += 1
                    batch += frame(TEXT, json.dumps({"type": "operation", "id": number, "epoch": 1, "name": "set", "arguments": {"words": ["amplitude=20"]}}).encode())
                viewer.sock.sendall(batch)
        except (OSError, Closed, AssertionError):
            time.sleep(0.01)


def stop_times(teacher, people):
    """From sending to when the last learner has seen the robot stopped, and to the answer."""
    seen, answered, confirmed = [], [], []
    for _ in range(STOP_TRIALS):
        for person in people:
            person.tell("run")
        end = time.monotonic() + 30
        while any((state := person.ask("stopped")) is None or state[1] != "running" for person in people) and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.2)
        begin = time.monotonic()
        stopped = teacher.stop()
        answered.append((time.monotonic() - begin) * 1000)
        confirmed.append(f"{stopped['confirmed']} of {stopped['of']}")
        while any(person.ask("stopped")[1] != "stopped" for person in people) and time.monotonic() < begin + 30:
            time.sleep(0.01)
        seen.append(max((person.ask("stopped")[0] - begin) * 1000 for person in people))
    for person in people:
        person.tell("run")
    return {"longest_ms": max(seen), "median_ms": percentile(seen, 0.5), "longest_answer_ms": max(answered), "confirmed": sorted(set(confirmed)), "trials": STOP_TRIALS}


def verdict(value, limit, is_upper=True):
    if value is None:
        return "no value"
    return "met" if (value <= limit if is_upper else value >= limit) else "NOT met"


def show(title, found):
    print(f"{title}:")
    print(f"  slider to result: p50 {found['p50_ms']:.1f} ms, p99 {found['p99_ms']:.1f} ms, worst {found['worst_ms']:.0f} ms, worst p99 of a learner "
          f"{found['worst_p99_ms_of_a_learner']:.1f} ms (limit of p99 {SLIDER_LIMIT_MS} ms: {verdict(found['p99_ms'], SLIDER_LIMIT_MS)}); "
          f"{found['answers']} answers of {found['expected']} moves, {found['unanswered']} not answered at the end")
    print(f"  simulated seconds a second: lowest {found['lowest_rate']:.3f} (limit {REAL_TIME}: {verdict(found['lowest_rate'], REAL_TIME, False)}); all {found['rates']}")
    print(f"  measured_factor of the documents, medians: {found['median_measured_factors']}")
    print(f"  rows a second of each learner: {found['rows_per_second']}")
    print("  processor, in percent of a core: " + ", ".join(f"{name} {value}" for name, value in found["processor_percent"].items()))
    print("  memory, RSS: " + ", ".join(f"{name} {value} MB" for name, value in found["memory_mb"].items()), flush=True)


def show_stop(title, found):
    print(f"{title}: longest {found['longest_ms']:.1f} ms (limit {STOP_LIMIT_MS} ms: {verdict(found['longest_ms'], STOP_LIMIT_MS)}), median {found['median_ms']:.1f} ms, "
          f"longest answer {found['longest_answer_ms']:.1f} ms, confirmed {', '.join(found['confirmed'])}", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source")
    parser.add_argument("programs")
    parser.add_argument("--learners", type=int, default=12)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    figures = {"learners": options.learners, "seconds": options.seconds, "cores": os.cpu_count(), "load_before": os.getloadavg()}
    with school() as folder, ClassProgram(folder, options.learners) as program, program.teacher() as teacher:
        people = [Person(program, f"Learner {number + 1}") for number in range(options.learners)]
        seats = {person.learner.seat: program.seat_process(person.learner.name) for person in people}
        processes = {"class": [program.process.pid], "all seats": list(program.seats())}
        own = multiprocessing.Event()
        looks = multiprocessing.Process(target=look_on, args=(program, [person.learner for person in people], own), daemon=True)
        looks.start()
        time.sleep(1)
        processes["clients of this measurement"] = [looks.pid, *(person.process.pid for person in people)]
        figures["quiet"] = measure(people, processes, options.seconds)
        figures["stop"] = stop_times(teacher, people)
        if not options.json:
            show(f"{options.learners} learners, a teacher who looks on", figures["quiet"])
            show_stop("STOP of the teacher, as learners see it", figures["stop"])

        *others, flooding, hanging, fast = people
        if others:
            ends = multiprocessing.Event()
            flooder = multiprocessing.Process(target=flood, args=(flooding.learner, ends), daemon=True)
            flooder.start()
            os.kill(seats[hanging.learner.seat], signal.SIGSTOP)
            fast.tell({"name": "factor", "value": 100})
            time.sleep(1)
            processes |= {"seat that is flooded": [seats[flooding.learner.seat]], "seat at factor 100": [seats[fast.learner.seat]], "flooding client": [flooder.pid]}
            figures["disturbed"] = measure(others, processes, options.seconds)
            figures["disturbed_stop"] = stop_times(teacher, others)
            ends.set()
            os.kill(seats[hanging.learner.seat], signal.SIGCONT)
            if not options.json:
                show("The others, while one floods, one robot hangs, one simulates at factor 100", figures["disturbed"])
                show_stop("STOP of the teacher, as the others see it", figures["disturbed_stop"])
            flooder.join(5)
            flooder.kill()
        own.set()
        for person in people:
            person.process.kill()
        looks.join(5)
    figures["load_after"] = os.getloadavg()
    print(json.dumps(figures) if options.json else f"load of the computer: {figures['load_before'][0]:.1f} before, {figures['load_after'][0]:.1f} after; {figures['cores']} cores")


if __name__ == "__main__":
    multiprocessing.set_start_method("fork")
    main()
