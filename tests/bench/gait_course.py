#!/usr/bin/env python3
"""A course for a robot that chooses its gait, in the reduced engine: learns the rules from recordings that are made here,
and prints how far the choosing robot comes, and how far with each gait alone; the same in ODE; and what rules of touch and
current reach, which are all that a module senses.

usage: /usr/bin/python3 tests/bench/gait_course.py build/host/bin [FOLDER]

FOLDER: for worlds, recordings, the learned scenario and a picture of a run (course.svg); by default a temporary one. Three
minutes on two cores.
"""

import json
import math
import random
import sqlite3
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROBOT = Path(__file__).resolve().parents[2] / "sim" / "scenarios" / "travelling_wave" / "caterpillar.robot.xml"
STEPS, SLOPE, FLAT = 1, 2, 3  # what the three sets are for
ACTUATION = """<actuation>
  <actuationModule name="SensingModule_gait_selector">
    <jointConfiguration joints="11111"/>
    <parameter name="amplitude_1" value="50"/>
    <parameter name="frequency_1" value="1.1"/>
    <parameter name="phase_difference_1" value="70"/>
    <parameter name="amplitude_2" value="30"/>
    <parameter name="frequency_2" value="1.7"/>
    <parameter name="phase_difference_2" value="77"/>
    <parameter name="amplitude_3" value="85"/>
    <parameter name="frequency_3" value="2.2"/>
    <parameter name="phase_difference_3" value="44"/>
    <parameter name="window" value="3000"/>
  </actuationModule>
</actuation>
"""
SENSED_BY_MODULES = [word for name in ("touch", "head_touch", "touch_changes", "current") for word in ("--feature", name)]
ON_ITS_FEET, ON_ITS_BACK = "0 0 0", "0 180 0"
# What proleg learn-selector gives, in figures that a person would write.
RULES = {"feature_2": 1, "threshold_2": 0.155, "feature_3": -1, "threshold_3": -0.064, "second_feature_3": -7,
         "second_threshold_3": 0.198, "hysteresis": 0}


def box(y, z, half_length, half_height, degrees=0, half_width=1):
    return f"""    <Body type="static">
      <Translation>0 {y:.6f} {z:.6f}</Translation>
      <RotationAxis>1 0 0 {degrees}</RotationAxis>
      <Geom type="box">
        <extents>{half_width} {half_length:.6f} {half_height:.6f}</extents>
        <friction>0.5</friction>
      </Geom>
    </Body>"""


def stairs(y, heights, run):
    return [box(y + (i + 0.5) * run, height / 2, run / 2, height / 2) for i, height in enumerate(heights)]


def slope(y, z, length, degrees):
    """A slab whose top begins at y and z."""
    angle, thick = math.radians(degrees), 0.05
    return [box(y + length / 2 * math.cos(angle) + thick * math.sin(angle),
                z + length / 2 * math.sin(angle) - thick * math.cos(angle), length / 2, thick, degrees)]


def rubble(y, length, highest, step, seed):
    draw, blocks, end = random.Random(seed), [], y + length
    while y < end:
        width, height = draw.uniform(0.5, 1.5) * step, draw.uniform(0.1, 1) * highest
        blocks.append(box(y + width / 2, height / 2, width / 2, height / 2))
        y += width
    return blocks


def course():
    """Stairs up and down, a ridge, rubble; between them flat ground. Returns the bodies and where the last one ends."""
    flat, tread, rise = 1.5, 0.3, 0.035
    y = flat
    bodies = stairs(y, [rise * step for step in (1, 2, 3, 4, 5, 5, 4, 3, 2, 1)], tread)
    y += 10 * tread + flat
    degrees, ramp, top = 20, 1.0, 0.8
    width, height = ramp * math.cos(math.radians(degrees)), ramp * math.sin(math.radians(degrees))
    bodies += slope(y, 0, ramp, degrees)
    bodies.append(box(y + width + top / 2, height / 2, top / 2, height / 2))
    bodies += slope(y + width + top, height, ramp, -degrees)
    y += 2 * width + top + flat
    bodies += rubble(y, 0.6, 0.05, 0.06, 3)
    return bodies, y + 0.6


class Course:
    def __init__(self, programs, folder):
        self.programs, self.folder = Path(programs), Path(folder)
        (self.folder / "selector.actuation.xml").write_text(ACTUATION)

    def write(self, name, bodies, pose):
        bodies = '  <KinBody name="ground">\n' + "\n".join(bodies) + "\n  </KinBody>\n" if bodies else ""
        (self.folder / f"{name}.environment.xml").write_text(f"""<Environment>
  <physicsengine type="reduced">
    <odeproperties>
      <gravity>0 0 -9.81</gravity>
    </odeproperties>
  </physicsengine>
  <KinBody name="floor">
{box(0, -0.003, 1000, 0.003, half_width=1000)}
  </KinBody>
{bodies}</Environment>
<!--Pose: ,0 0 0.026,{pose},-->
""")
        (self.folder / f"{name}.simulation.xml").write_text(f"""<simulation>
  <robot>{ROBOT}</robot>
  <actuation>selector.actuation.xml</actuation>
  <environment>{name}.environment.xml</environment>
  <simulationProperties><duration>20</duration></simulationProperties>
</simulation>
""")

    def proleg(self, *arguments):
        done = subprocess.run([self.programs / "proleg", *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
        return json.loads(done.stdout)

    def simulate(self, name, seconds, settings, *options):
        """How far the robot comes along the course, in m."""
        words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        result = self.proleg("simulate", self.folder / f"{name}.simulation.xml", "--seconds", seconds, "--json", *words,
                             *options)
        return result["measures"]["speed"] * seconds

    @staticmethod
    def only(number):
        """Settings with which one set is played from the beginning: a rule that always holds, and no time to wait."""
        return {} if number == 1 else {f"feature_{number}": 4, f"threshold_{number}": -1, "window": 1, "dwell": 0}

    def record(self):
        """Recordings of each gait on each ground, from both sides; the words with which they are labelled."""
        draw = random.Random(3)
        grounds = {"flat": ([], FLAT), "stairs": (stairs(0, [0.035 * (i + 1) for i in range(40)], 0.3), STEPS),
                   "steep_stairs": (stairs(0, [0.03 * (i + 1) for i in range(40)], 0.2), STEPS),
                   "slope_18": (slope(0.35, 0, 12, 18), SLOPE), "slope_22": (slope(0.35, 0, 12, 22), SLOPE),
                   "rubble": (rubble(0, 8, 0.05, 0.06, 3), STEPS), "other_rubble": (rubble(0, 8, 0.05, 0.06, 11), STEPS)}
        # From the gait of another ground the way may lead over the gait that climbs everything.
        also_right = {(FLAT, SLOPE): "1,", (SLOPE, FLAT): "1,", (STEPS, FLAT): "2,"}
        runs, words = [], []
        for repetition in range(3):
            for ground, (bodies, number) in grounds.items():
                for side, pose in (("feet", ON_ITS_FEET), ("back", ON_ITS_BACK)):
                    name = f"{ground}_{side}"
                    self.write(name, bodies, pose)
                    for played in (1, 2, 3):
                        file = self.folder / f"{name}_{played}_{repetition}.proleg"
                        at = draw.uniform(-0.1, 0.1) if number == SLOPE else draw.uniform(0.6, 1.6)
                        runs.append((name, 30 if number == SLOPE else 20, self.only(played), "--seed", repetition + 1,
                                     "--at", f"0,{at:.3f}", "--friction", f"{draw.uniform(0.45, 0.55):.3f}", "--record",
                                     file))
                        part = "@6-30" if number == SLOPE else ""
                        words.append(f"{also_right.get((number, played), '')}{number}={file}{part}")
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda run: self.simulate(*run), runs))
        return words

    def learn(self, words, *options, name="learned"):
        return self.proleg("learn-selector", *words, *options, "--out", self.folder / name, "--json")

    def distances(self, rules, seconds, starts, *options):
        """How far the robot comes from starts before the course, on its feet and on its back, in m: with the rules (0), and
        with each set alone. options: of proleg simulate. Returns {(pose, number): [distance for each start]}."""
        bodies, end = course()
        self.write("course_feet", bodies, ON_ITS_FEET)
        self.write("course_back", bodies, ON_ITS_BACK)
        keys = [(side, number) for side in ("feet", "back") for number in (0, 1, 2, 3)]
        runs = [(f"course_{side}", seconds, self.only(number) if number else rules, "--at", f"0,{-start:.3f}", *options)
                for side, number in keys for start in starts]
        with ThreadPoolExecutor(2) as pool:
            results = list(pool.map(lambda run: self.simulate(*run), runs))
        return {key: results[i * len(starts):(i + 1) * len(starts)] for i, key in enumerate(keys)}, end


def picture(recording, bodies):
    """The course from its side, and where the head was while each set was played."""
    data = sqlite3.connect(recording)
    head = data.execute("SELECT tick, y_m, z_m FROM pose WHERE link = 0 AND tick % 20 = 0 ORDER BY tick").fetchall()
    number, = data.execute("SELECT value_index FROM internal_value_name WHERE slot = 0 AND name = 'set'").fetchone()
    played = {tick: int(raw) for tick, raw in
              data.execute("SELECT tick, raw FROM internal_value WHERE slot = 0 AND joint = 0 AND value_index = ?", (number,))}
    data.close()
    _, end = course()
    scale, base, colours = 70, 60, {1: "#d55e00", 2: "#0072b2", 3: "#009e73"}
    width = round((end + 1) * scale)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} 115" font-family="sans-serif" font-size="12">',
             f'<rect width="{width}" height="115" fill="#fff"/>']
    for body in bodies:
        y, z = (float(word) for word in body.split("<Translation>0 ")[1].split("<")[0].split())
        degrees = float(body.split("<RotationAxis>1 0 0 ")[1].split("<")[0])
        half_length, half_height = (float(word) for word in body.split("<extents>1 ")[1].split("<")[0].split())
        lines.append(f'<rect x="{(y - half_length) * scale:.1f}" y="{base - (z + half_height) * scale:.1f}" '
                     f'width="{2 * half_length * scale:.1f}" height="{2 * half_height * scale:.1f}" fill="#bbb" '
                     f'transform="rotate({-degrees} {y * scale:.1f} {base - z * scale:.1f})"/>')
    lines.append(f'<rect y="{base}" width="{width}" height="55" fill="#fff"/>')
    lines.append(f'<line x1="0" y1="{base}" x2="{width}" y2="{base}" stroke="#777"/>')
    while len(head) > 1 and head[0][1] < end + 1:
        same = next((i for i, (tick, *_) in enumerate(head) if played[tick] != played[head[0][0]]), len(head) - 1)
        points = " ".join(f"{y * scale:.0f},{base - z * scale:.1f}" for _, y, z in head[:same + 1])
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colours[played[head[0][0]]]}" stroke-width="2"/>')
        head = head[same:]
    texts = {1: "set 1: steps and rubble", 2: "set 2: slopes", 3: "set 3: flat ground"}
    for i, (each, text) in enumerate(texts.items()):
        lines.append(f'<rect x="{10 + 170 * i}" y="{base + 30}" width="12" height="12" fill="{colours[each]}"/>'
                     f'<text x="{28 + 170 * i}" y="{base + 41}">{text}</text>')
    for metre in range(1, int(end) + 1):
        lines.append(f'<text x="{metre * scale}" y="{base + 16}" text-anchor="middle" fill="#555">{metre} m</text>')
    return "\n".join(lines) + "\n</svg>\n"


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        made = Course(sys.argv[1], folder)
        words = made.record()
        learned = made.learn(words)
        print(f"rules from {len(words)} recordings: " +
              "; ".join(f"set {number}: {rule}" for number, rule in learned["rules"].items()) +
              f"; hysteresis {learned['parameters']['hysteresis']:.2f}")
        print(f"right {100 * learned['right']:.1f} %, on unseen recordings {100 * learned['unseen_right']:.1f} %, "
              f"{learned['changes_per_minute']:.2f} changes a minute")
        starts = 0.07, 0.14, 0.21
        for text, rules, engine in (("learned rules", learned["parameters"], "reduced"), ("rules of RULES", RULES, "reduced"),
                                    ("rules of RULES, ODE", RULES, "ode")):
            distances, end = made.distances(rules, 300, starts, "--engine", engine)
            print(f"distances in m in 300 s with {text}; the last obstacle ends at {end:.2f} m")
            for (side, number), metres in distances.items():
                name = f"set {number} alone" if number else "chooses"
                print(f"  starts on its {side:5} {name:12} " + "  ".join(f"{each:6.2f}" for each in metres))
        on_feet = [word for word in words if "_back_" not in word]
        for window in (1500, 3000, 6000):
            sensed = made.learn(on_feet, "--window", window, *SENSED_BY_MODULES, name=f"sensed_{window}")
            reached = [made.simulate("course_feet", 300, sensed["parameters"] | {"window": window}, "--at", f"0,{-start:.3f}")
                       for start in starts]
            print(f"rules of touch and current, window {window} ms, from recordings on its feet: "
                  f"{100 * sensed['unseen_right']:.1f} % right on unseen ones; course "
                  + "  ".join(f"{metres:6.2f}" for metres in reached))
        recording = folder / "course.proleg"
        made.simulate("course_back", 150, RULES, "--record", recording)
        (folder / "course.svg").write_text(picture(recording, course()[0]))


if __name__ == "__main__":
    main()
