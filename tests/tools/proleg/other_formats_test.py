"""Robots of other programs: `proleg import` and `proleg export --urdf, --mjcf`.

Oracles from outside: check_urdf, the reader of urdfdom's own package, and a shipped robot that goes to URDF and back: its gait has the
same set-points, and moves it as far.

usage: other_formats_test.py SOURCE_DIR PROGRAM_DIR
"""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

LONGEST = 300  # s, for a command that takes a second on an idle computer

# Numbers of the two files differ by less than 1e-9 (tests/sim/urdf), those of meshes by 1e-7 of their size: an STL file has 24 bits.
# Contacts amplify such differences. Measured in 10 s: none without meshes, 0.3 % with them (robots/y1). The last bits depend on
# processor and compiler, therefore 2 % for all. robots/cubo is missing: its links have parts with different frictions, which URDF loses.
TOLERANCE = 0.02
ROUND_TRIPS = ["travelling_wave/uniform", "travelling_wave/tail_fixed", "robots/snake/robot",
               "robots/cube_chain/robot", "robots/y1/robot", "gaits/rolling"]


class OtherFormats(unittest.TestCase):
    source = None
    programs = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.robots = self.source / "tests/sim/urdf/robots"

    def command(self, program, *words):
        return subprocess.run([self.programs / f"proleg-{program}", *words], capture_output=True, text=True, timeout=LONGEST,
                              check=False, cwd=self.folder)

    def must(self, program, *words):
        finished = self.command(program, *words)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return finished.stdout

    def refused(self, program, *words, message):
        finished = self.command(program, *words)
        self.assertEqual((finished.returncode, finished.stdout, finished.stderr.count("\n")), (2, "", 1), finished.stderr)
        self.assertIn(message, finished.stderr)

    def simulated(self, file, seconds="10"):
        return json.loads(self.must("simulate", file, "--seconds", seconds, "--json"))

    def scenario(self, name):
        return self.source / f"sim/scenarios/{name}.simulation.xml"

    def same_gait(self, name, folder):
        """The scenario with the robot of a folder."""
        top = ElementTree.parse(self.scenario(name))
        for tag in ("actuation", "environment"):
            element = top.getroot().find(tag)
            element.text = str((self.scenario(name).parent / element.text.strip()).resolve())
        top.getroot().find("robot").text = "robot.robot.xml"
        file = folder / "again.simulation.xml"
        top.write(file)
        return file

    def test_a_shipped_robot_goes_to_urdf_and_back(self):
        for name in ROUND_TRIPS:
            with self.subTest(name):
                urdf = self.folder / (name.replace("/", "_") + ".urdf")
                self.must("export", self.scenario(name), "--urdf", urdf)
                self.must("import", urdf)
                before = self.simulated(self.scenario(name))
                after = self.simulated(self.same_gait(name, self.folder / urdf.stem))
                self.assertEqual(after["setpoint_hash"], before["setpoint_hash"])
                was, now = before["displacement_m"], after["displacement_m"]
                print(f"{name}: {was:.6f} m before, {now:.6f} m after URDF ({now / was - 1:+.2e})")
                self.assertLess(abs(now - was), TOLERANCE * was)

    def test_the_new_scenario_moves_at_once(self):
        printed = self.must("import", self.robots / "snake.urdf", "--out", "mine")
        self.assertIn("run it:  proleg simulate mine/robot.simulation.xml\n", printed)
        result = self.simulated(self.folder / "mine/robot.simulation.xml")
        self.assertGreater(result["displacement_m"], 0.1)
        self.refused("import", self.robots / "snake.urdf", "--out", "mine", message="found an existing file")

    def test_lists_what_is_lost(self):
        printed = self.must("import", self.robots / "arm.urdf")
        self.assertIn("lost     <transmission> (line ", printed)
        self.assertIn("lost     the link 'world', to which the robot is fixed", printed)

    def test_a_bad_file_is_refused_in_one_line(self):
        robot = self.robots / "prismatic_gripper.urdf"
        self.refused("import", robot, message=f"{robot}:5: found joint 'finger_joint' of type 'prismatic', expected 'revolute'")
        self.assertEqual(list(self.folder.iterdir()), [])
        self.refused("import", "nowhere.urdf", message="nowhere.urdf: found no file that can be read")
        self.refused("import", self.robots / "snake.urdf", "--package", "a", message="--package: found 'a', expected NAME=FOLDER")
        self.refused("import", self.robots / "snake.urdf", "--density", "0", message="--density: found 0")

    def test_check_urdf_takes_the_export(self):
        check = shutil.which("check_urdf")
        self.assertTrue(check, "liburdfdom-tools is missing")
        for name, joints in [("travelling_wave/uniform", 5), ("robots/y1/robot", 5), ("long_chain/sixty", 60)]:
            urdf = self.folder / "robot.urdf"
            self.must("export", self.scenario(name), "--urdf", urdf)
            finished = subprocess.run([check, urdf], capture_output=True, text=True, timeout=LONGEST, check=False)
            self.assertEqual(finished.returncode, 0, finished.stdout)
            self.assertIn("root Link: base_link has 1 child(ren)", finished.stdout)
            self.assertEqual(len(ElementTree.parse(urdf).getroot().findall("joint[@type='revolute']")), joints)

    def test_meshes_are_written_beside_the_urdf(self):
        printed = self.must("export", self.scenario("robots/y1/robot"), "--urdf", "out/y1.urdf")
        self.assertIn("out/y1.urdf\n", printed)
        names = {mesh.get("filename") for mesh in ElementTree.parse(self.folder / "out/y1.urdf").iter("mesh")}
        self.assertTrue(names)
        for name in names:
            data = (self.folder / "out" / name).read_bytes()
            self.assertEqual(len(data), 84 + 50 * int.from_bytes(data[80:84], "little"))
        self.must("export", self.scenario("robots/y1/robot"), "--urdf", "out/y1.urdf")  # replaces its own files
        (self.folder / "notes.txt").write_text("mine\n")
        self.refused("export", self.scenario("robots/y1/robot"), "--urdf", "notes.txt", message="notes.txt")
        self.refused("export", self.scenario("robots/y1/robot"), "--urdf", "-", message="--urdf: found standard output")

    def test_a_recording_has_its_robot(self):
        self.must("simulate", self.scenario("travelling_wave/uniform"), "--seconds", "1", "--record", "run.proleg")
        for option in ("--urdf", "--mjcf"):
            self.assertEqual(self.must("export", "run.proleg", option, "-"),
                             self.must("export", self.scenario("travelling_wave/uniform"), option, "-"))

    def test_the_model_of_mujoco_has_names_actuators_and_a_start(self):
        model = ElementTree.fromstring(self.must("export", self.scenario("travelling_wave/uniform"), "--mjcf", "-"))
        self.assertEqual([body.get("name") for body in model.iter("body")], ["Head", "4Seg", "3Seg", "2Seg", "1Seg", "Tail"])
        self.assertEqual([actuator.get("joint") for actuator in model.find("actuator")], ["J5", "J4", "J3", "J2", "J1"])
        start = [float(value) for value in model.find("keyframe/key").get("qpos").split()]
        self.assertEqual(len(start), 7 + 5)

    def test_the_forms_of_an_export_exclude_each_other(self):
        self.refused("export", "caterpillar", "--urdf", "a.urdf", "--html", message="--html")
        self.refused("export", "caterpillar", "--urdf", "a.urdf", "--out", "b", message="--out")
        self.refused("export", "caterpillar", "--urdf", "-", "--mjcf", "-", message="--mjcf: found standard output")


if __name__ == "__main__":
    OtherFormats.source = Path(sys.argv[1]).resolve()
    OtherFormats.programs = Path(sys.argv[2]).resolve()
    unittest.main(argv=sys.argv[:1])
