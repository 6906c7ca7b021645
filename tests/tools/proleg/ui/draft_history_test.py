"""Undo and redo of everything that a person can make, through the program as a page uses it: 500 seeded random operations in
all parts, with simulations, restarts, rewinds, reloads of the page, Save, and new starts of the program in between. Each
earlier state comes back: the document of the draft and the texts of its files.

Usage: draft_history_test.py SOURCE PROGRAMS [SEED [OPERATIONS]]"""

import json
import random
import shutil
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 48
OPERATIONS = int(sys.argv[4]) if len(sys.argv) > 4 else 500
sys.path[:0] = [str(SOURCE / "tests/host/server"), str(SOURCE / "tests/tools/proleg/ui")]
from ui_program import UiProgram  # noqa: E402

MOST_OBJECTS, MOST_JOINTS, MOST_SENSORS = 25, 12, 8


class Program(UiProgram):
    def texts(self):
        """The files of the draft as they are now, by their names."""
        texts = {str(path.relative_to(self.folder)): path.read_text() for path in self.folder.rglob("*.xml")}
        for file in self.must("draft.diff")["files"]:
            texts[str(Path(file["name"]).relative_to(self.folder))] = file["new"]
        return texts

    def state(self):
        texts = self.texts()
        beside = ("revision", "undo", "redo", "changed", "layout", "unsaved")
        return {name: value for name, value in self.draft.items() if name not in beside}, texts


def random_operation(draft, number):
    """The name and the arguments of an operation that may be refused."""
    joints, links, sensors = (len(draft["robot"][name]) for name in ("joints", "links", "sensors"))
    objects, rulers = len(draft["world"]["objects"]), len(draft["world"]["rulers"])
    modules = len(draft["behaviour"]["modules"])

    def real(lowest, highest):
        return round(random.uniform(lowest, highest), 3)

    def place():
        return [real(-3, 3), real(-3, 3), real(0, 0.3)]

    def some_joints():
        return sorted(random.sample(range(joints), random.randint(1, joints)))

    def of(count):
        return random.randrange(max(1, count))

    thing, group = of(objects), random.random() < 0.5
    algorithms = ["PatternGenerator_sinusoidal", "DirectJointAccess", "PatternGenerator_Ijspeert_2006"]
    kinds = ["caterpillar", "snake", "cubo"]
    makers = {
        "world.place": lambda: {"object": thing, "pose": [*place(), 1, 0, 0, 0], "group": group},
        "world.resize": lambda: {"object": thing, "shape": 0, "size": [real(0.02, 1), real(0.02, 1), real(0.02, 0.2)]},
        "world.friction": lambda: {"object": thing, "value": random.choice([None, real(0, 2)])},
        "world.colour": lambda: {"object": thing, "value": [real(0, 1), real(0, 1), real(0, 1)]},
        "world.moves": lambda: {"object": thing, "value": random.random() < 0.5},
        "world.mass": lambda: {"object": thing, "value": real(0.05, 2)},
        "world.rename": lambda: {"object": thing, "name": f"thing {number}"},
        "world.remove": lambda: {"objects": [thing], "group": group},
        "world.duplicate": lambda: {"objects": [thing], "group": group, "step": place(), "count": random.randint(1, 3)},
        "world.add": lambda: {"item": random.choice(["box", "ramp", "stairs", "hills", "rough ground"]), "position": place(), "turn": real(-90, 90)},
        "world.start": lambda: {"position": place(), "degrees": [0, 0, real(-180, 180)]},
        "world.ruler": lambda: {"from": place(), "to": place(), **({"ruler": of(rulers)} if rulers else {})},
        "world.remove_ruler": lambda: {"ruler": of(rulers)},
        "robot.axis": lambda: {"joints": some_joints(), "value": random.choice([[1, 0, 0], [0, 0, 1], [0.6, 0, 0.8]])},
        "robot.limits": lambda: {"joints": some_joints(), "lower": -real(20, 90), "upper": real(20, 90)},
        "robot.torque": lambda: {"joints": some_joints(), "value": real(0.2, 2)},
        "robot.speed": lambda: {"joints": some_joints(), "value": real(2, 8)},
        "robot.rename_joint": lambda: {"joint": of(joints), "name": f"joint_{number}"},
        "robot.rename": lambda: {"name": f"worm{number}"},
        "robot.servo": lambda: {"name": "gain", "value": real(5, 60)},
        "robot.mass": lambda: {"link": of(links), "value": real(0.05, 0.5)},
        "robot.friction": lambda: {"link": of(links), "value": random.choice([None, real(0, 2)])},
        "robot.duplicate": lambda: {"joint": of(joints)},
        "robot.remove": lambda: {"joint": of(joints)},
        "robot.count": lambda: {"value": random.randint(2, MOST_JOINTS)},
        "robot.order": lambda: {"order": random.sample(range(joints), joints)},
        "robot.kind": lambda: {"kind": random.choice(kinds), "link": random.choice([None, of(links)])},
        "robot.add_sensor": lambda: {"kind": random.choice(["TactileSensor", "Inclinometer"]), "part": of(links), "place": random.choice(["front", "below"])},
        "robot.remove_sensor": lambda: {"sensor": of(sensors)},
        "robot.rename_sensor": lambda: {"sensor": of(sensors), "name": f"sensor_{number}"},
        "behaviour.add": lambda: {"algorithm": random.choice(algorithms), "joints": some_joints()},
        "behaviour.duplicate": lambda: {"module": of(modules), "joints": some_joints()},
        "behaviour.joints": lambda: {"module": of(modules), "joints": some_joints()},
        "behaviour.remove": lambda: {"module": of(modules)},
        "behaviour.algorithm": lambda: {"module": of(modules), "algorithm": random.choice(algorithms)},
        "behaviour.set": lambda: {"module": of(modules), "parameter": "amplitude", "joints": some_joints(), "value": str(real(0, 60))},
        "draft.run": lambda: dict(random.choice([{"name": "duration", "value": real(1, 60)}, {"name": "seed", "value": str(number)}, {"name": "engine", "value": "reduced"},
                                                 {"name": "engine", "value": "ode"}, {"name": "gravity", "value": [0, 0, -real(1, 10)]}])),
    }
    names = list(makers)
    if objects > MOST_OBJECTS:
        names = ["world.remove"]
    elif joints >= MOST_JOINTS:
        names = ["robot.remove", "robot.count"]
    elif sensors > MOST_SENSORS:
        names = ["robot.remove_sensor"]
    name = random.choice(names)
    return name, makers[name](), set(makers)


def same(found, wanted):
    """Files that were saved and are not named any more may stay on the disk."""
    return found[0] == wanted[0] and all(found[1].get(name) == text for name, text in wanted[1].items())


def difference(found, wanted):
    """What is not the same, for a message."""
    documents = [(name, found[0].get(name), value) for name, value in wanted[0].items() if found[0].get(name) != value]
    return documents or [(name, found[1].get(name), text) for name, text in wanted[1].items() if found[1].get(name) != text]


def between(program):
    """What a person does between two changes, and what must change nothing of the draft. An engine may refuse a simulation of it,
    and a simulation may fail."""
    what = random.choice(["load_draft", "restart", "step", "load_page", "refresh", "save"])
    if what == "load_draft":
        program.ask("load_draft")
    elif what == "restart":
        program.ask("run")
        program.ask("restart")
        program.ask("pause")
    elif what == "step":
        program.ask("step", ticks=20)
    elif what == "load_page":
        program.load_page()
    elif what == "refresh":
        program.must("draft.refresh")
    else:
        program.must("draft.save")


def start_again(program):
    """The program ends and starts: what is not saved is offered, and is one change then. Returns the new states."""
    wanted = program.state()
    program.end()
    program.start()
    states = [program.state()]
    if program.draft["unsaved"] is not None:
        program.must("draft.restore")
        states.append(program.state())
    assert same(states[-1], wanted), ("a new start brings back what was not saved", difference(states[-1], wanted))
    return states


def make_and_undo(program):
    """Returns how often each kind of operation changed something, and how many were refused."""
    states, at = [program.state()], 0
    done, refused, kinds = {}, 0, set()
    for number in range(OPERATIONS):
        context = f"seed {SEED}, operation {number}"
        choice = random.random()
        if number in (OPERATIONS // 3, 2 * OPERATIONS // 3):
            states = start_again(program)
            at = len(states) - 1
        elif choice < 0.2:
            assert program.ask("draft.undo")["ok"] == (at > 0), context
            at = max(0, at - 1)
        elif choice < 0.35:
            assert program.ask("draft.redo")["ok"] == (at + 1 < len(states)), context
            at = min(len(states) - 1, at + 1)
        elif choice < 0.45:
            between(program)
        else:
            operation, arguments, kinds = random_operation(program.draft, number)
            context = f"{context}: {operation} {arguments}"
            result = program.ask(operation, **arguments)
            if not result["ok"]:
                assert result["error"] and "\n" not in result["error"], (context, result)
                refused += 1
            elif (now := program.state()) != states[at]:
                states[at + 1:] = [now]
                at += 1
                done[operation] = done.get(operation, 0) + 1
        now = program.state()
        assert same(now, states[at]), (context, difference(now, states[at]))
    while at > 0:
        program.must("draft.undo")
        at -= 1
        assert same(program.state(), states[at]), f"seed {SEED}, back at state {at}"
    assert not program.ask("draft.undo")["ok"]
    return done, refused, sorted(kinds - set(done))


def main():
    random.seed(SEED)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        with Program(PROGRAMS, folder) as program:
            done, refused, missing = make_and_undo(program)
            program.end()
    print(json.dumps({"seed": SEED, "done": done, "refused": refused, "missing": missing}))
    assert OPERATIONS < 500 or len(missing) <= len(done) // 4, f"too few kinds of operations: without {missing}"


main()
