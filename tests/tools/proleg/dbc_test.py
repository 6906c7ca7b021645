#!/usr/bin/env python3
"""Reads the DBC files of 'proleg objects --dbc' by the format's grammar, strictly, and decodes frames with them.

The frames are the examples of docs/protocol.md and the log of a run of 'proleg hil', whose recording has the same values.

Usage: dbc_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import csv
import io
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ANY_NODE = "Vector__XXX"
MAX_NAME = 32
C_KEYWORDS = set("""auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
""".split())

NAME = r"[A-Za-z_][A-Za-z0-9_]*"
NUMBER = r"-?(?:0|[1-9]\d*)(?:\.\d+)?(?:e[+-]?\d+)?"
STRING = r'"[^"\\]*"'
VALUES = rf"(?: -?\d+ {STRING})+"
MESSAGE = re.compile(rf"BO_ (\d+) ({NAME}): (\d) ({NAME})")
SIGNAL = re.compile(rf" SG_ ({NAME})(?: (M|m\d+))? : (\d+)\|(\d+)@([01])([+-]) \(({NUMBER}),({NUMBER})\) "
                    rf"\[({NUMBER})\|({NUMBER})\] ({STRING}) +({NAME}(?:, *{NAME})*)")
COMMENT = re.compile(rf"CM_ (?:(BU_) ({NAME}) |(BO_) (\d+) |(SG_) (\d+) ({NAME}) )?({STRING});")
VALUE_TABLE = re.compile(rf"VAL_TABLE_ ({NAME})({VALUES}) ;")
SIGNAL_VALUES = re.compile(rf"VAL_ (\d+) ({NAME})({VALUES}) ;")
# In this order.
SECTIONS = ("VERSION", "NS_", "BS_", "BU_", "VAL_TABLE_", "BO_", "CM_", "VAL_")


class Malformed(Exception):
    pass


def expect(condition, error):
    if not condition:
        raise Malformed(error)


def parse_values(text):
    values = {}
    for number, name in re.findall(rf"(-?\d+) ({STRING})", text):
        expect(int(number) not in values, f"value {number} twice")
        expect(name != '""', f"value {number} has no name")
        values[int(number)] = name[1:-1]
    return values


class Signal:
    def __init__(self, match):
        (self.name, self.multiplex, start, bits, order, sign, factor, offset, low, high, unit, receivers) = match.groups()
        self.start, self.bits = int(start), int(bits)
        expect(order == "1", f"{self.name} is not little-endian")
        self.signed = sign == "-"
        self.factor, self.offset = float(factor), float(offset)
        expect(self.factor != 0, f"{self.name} has the factor 0")
        self.low, self.high, self.unit = float(low), float(high), unit[1:-1]
        self.receivers = [name.strip() for name in receivers.split(",")]
        self.values, self.comment = {}, None
        lowest = -2 ** (self.bits - 1) if self.signed else 0
        self.raw = range(lowest, lowest + 2 ** self.bits)
        if (self.low, self.high) != (0, 0):
            expect(self.low < self.high, f"{self.name} has the range {self.low} to {self.high}")
            expect(self.raw[0] <= self.low / self.factor and self.high / self.factor <= self.raw[-1],
                   f"the range of {self.name} does not fit into its bits")

    def places(self):
        return set(range(self.start, self.start + self.bits))

    def raw_value(self, data):
        raw = int.from_bytes(data, "little") >> self.start & (1 << self.bits) - 1
        return raw - (1 << self.bits) if self.signed and raw >> self.bits - 1 else raw

    def value(self, data):
        raw = self.raw_value(data)
        return self.values.get(raw, raw * self.factor + self.offset)


class Message:
    def __init__(self, match):
        identifier, self.name, length, self.sender = match.groups()
        self.identifier, self.length = int(identifier), int(length)
        self.signals, self.comment = {}, None
        expect(self.identifier <= 0x7FF, f"{self.name} has no identifier of 11 bits")
        expect(1 <= self.length <= 8, f"{self.name} has {length} bytes")

    def add(self, signal):
        names = {name.lower() for name in self.signals}  # some readers do not tell upper from lower case
        expect(signal.name.lower() not in names, f"{self.name} has {signal.name} twice")
        expect(signal.start + signal.bits <= 8 * self.length, f"{signal.name} is outside {self.name}")
        self.signals[signal.name] = signal

    def selector(self):
        found = [signal for signal in self.signals.values() if signal.multiplex == "M"]
        return found[0] if found else None

    def present(self, selected):
        return [signal for signal in self.signals.values() if signal.multiplex in (None, "M", f"m{selected}")]

    def check(self):
        selectors = [signal for signal in self.signals.values() if signal.multiplex == "M"]
        selected = {int(signal.multiplex[1:]) for signal in self.signals.values()
                    if signal.multiplex and signal.multiplex != "M"}
        expect(len(selectors) == (1 if selected else 0), f"{self.name} has {len(selectors)} multiplexers")
        if selected:
            expect(set(selectors[0].values) == selected, f"{self.name}: values of the multiplexer and its signals differ")
        for value in selected or {None}:
            taken = set()
            for signal in self.present(value):
                expect(not taken & signal.places(), f"{self.name}: {signal.name} overlaps another signal")
                taken |= signal.places()
        expect(self.signals, f"{self.name} has no signals")
        expect(self.comment, f"{self.name} has no comment")

    def decode(self, data):
        """Values by name; a value that has a name is that name."""
        if len(data) != self.length:
            raise ValueError(f"{self.name} has {self.length} bytes, not {len(data)}")
        selector = self.selector()
        selected = selector.raw_value(data) if selector else None
        if selector and selected not in selector.values:
            raise ValueError(f"{self.name} has no signals for {selected}")
        return {signal.name: signal.value(data) for signal in self.present(selected)}


class Dbc:
    def __init__(self, text):
        expect(text.isascii() and text.endswith("\n"), "not lines of ASCII")
        self.nodes, self.messages, self.tables, self.node_comments, self.comment = [], {}, {}, {}, None
        section, message = 0, None
        for line in text.splitlines():
            if not line:
                message = None
                continue
            if line.startswith(" SG_"):
                match = SIGNAL.fullmatch(line)
                expect(match and message, f"a signal: {line}")
                message.add(Signal(match))
                continue
            message = None
            keyword = re.match("[A-Z_]+", line)[0] if re.match("[A-Z_]+", line) else ""
            expect(keyword in SECTIONS[section:], f"{line[:40]} after {SECTIONS[section]}")
            expect(SECTIONS.index(keyword) > section or section == 0 or keyword in SECTIONS[4:], f"{keyword} twice")
            section = SECTIONS.index(keyword)
            message = self.section(keyword, line)
        expect(section > 0 and self.nodes and self.messages, "no messages")
        self.check()

    def section(self, keyword, line):
        if keyword == "VERSION":
            expect(re.fullmatch(rf"VERSION {STRING}", line), line)
        elif keyword in ("NS_", "BS_"):
            expect(re.fullmatch(rf"{keyword} ?:", line), line)
        elif keyword == "BU_":
            expect(re.fullmatch(rf"BU_:( {NAME})*", line), line)
            self.nodes = line.split()[1:]
        elif keyword == "VAL_TABLE_":
            match = VALUE_TABLE.fullmatch(line)
            expect(match and match[1] not in self.tables, line)
            self.tables[match[1]] = parse_values(match[2])
        elif keyword == "BO_":
            match = MESSAGE.fullmatch(line)
            expect(match, line)
            message = Message(match)
            expect(message.identifier not in self.messages, f"identifier {message.identifier} twice")
            self.messages[message.identifier] = message
            return message
        elif keyword == "CM_":
            self.add_comment(line)
        else:
            match = SIGNAL_VALUES.fullmatch(line)
            expect(match, line)
            signal = self.signal(int(match[1]), match[2])
            expect(not signal.values, f"values of {signal.name} twice")
            signal.values = parse_values(match[3])
            expect(all(value in signal.raw for value in signal.values), f"{signal.name} cannot have all of its values")
        return None

    def signal(self, identifier, name):
        expect(identifier in self.messages and name in self.messages[identifier].signals, f"no signal {name}")
        return self.messages[identifier].signals[name]

    def add_comment(self, line):
        match = COMMENT.fullmatch(line)
        expect(match, line)
        text = match[8][1:-1]
        expect(text, f"an empty comment: {line}")
        if match[1]:
            expect(match[2] in self.nodes and match[2] not in self.node_comments, line)
            self.node_comments[match[2]] = text
            return
        if match[3]:
            expect(int(match[4]) in self.messages, line)
            target = self.messages[int(match[4])]
        elif match[5]:
            target = self.signal(int(match[6]), match[7])
        else:
            target = self
        expect(target.comment is None, f"a second comment: {line}")
        target.comment = text

    def check(self):
        message_names = [message.name for message in self.messages.values()]
        signals = [signal for message in self.messages.values() for signal in message.signals.values()]
        for names in (self.nodes, message_names):
            expect(len({name.lower() for name in names}) == len(names), "a name twice")
        for name in self.nodes + message_names + [signal.name for signal in signals]:
            expect(len(name) <= MAX_NAME and name not in C_KEYWORDS, f"{name} is no short identifier of C")
        for name in [message.sender for message in self.messages.values()] + sum((s.receivers for s in signals), []):
            expect(name in self.nodes or name == ANY_NODE, f"no node {name}")
        for message in self.messages.values():
            message.check()

    def decode(self, identifier, data):
        message = self.messages[identifier]
        return message.name, message.decode(data)


def read_log(text):
    """Frames of a candump log: identifier and data."""
    for line in text.splitlines():
        match = re.fullmatch(r"\(\d+\.\d{6}\) \w+ ([0-9A-F]{3})#((?:[0-9A-F]{2})*)", line)
        yield int(match[1], 16), bytes.fromhex(match[2])


class DbcTest(unittest.TestCase):
    source = programs = None

    def proleg(self, *words):
        run = subprocess.run([self.programs / "proleg", *map(str, words)], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout

    def scenario(self, name):
        return self.source / f"sim/scenarios/{name}.simulation.xml"

    def documented(self):
        return (self.source / "docs/proleg.dbc").read_text(encoding="ascii")

    def test_every_example_of_the_protocol_is_decoded(self):
        dbc = Dbc(self.documented())
        examples = re.findall(r"^    ([0-9A-F]{3}) \[(\d)\]((?: [0-9A-F]{2})+)$",
                              (self.source / "docs/protocol.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
        self.assertGreater(len(examples), 30)
        decoded = {}
        for identifier, length, data in examples:
            self.assertEqual(len(bytes.fromhex(data)), int(length))
            decoded[identifier + data] = dbc.decode(int(identifier, 16), bytes.fromhex(data))
        for frame, name, expected in (
                ("080 2D", "Sync", {"counter": 300 % 128 + 1}),
                ("681 2C 01 00 00 E2 C3 17 5A", "Tick", {"tick": 300, "configuration_crc": 0x5A17C3E2}),
                ("680 07 00 40 01 00 00 01 00", "Commit", {"transaction": 7, "tick": 320, "robot": 1}),
                ("000 01 03", "Nmt", {"command": "Start", "node": 3}),
                ("703 00", "Node3_Heartbeat", {"state": "Boot-up"}),
                ("703 05", "Node3_Heartbeat", {"state": "Operational"}),
                ("77F 05", "Host_Heartbeat", {"state": "Operational"}),
                ("183 8E E3 38 4E 72 1C 83 2C", "Node3_State",
                 {"current_phase": 110, "valid": 1, "contact_rear_link_rear": 1,
                  "contact_rear_link_front": 1, "contact_far_link_rear": 0, "contact_far_link_front": 0, "fault": 0,
                  "holdover": 0, "limited": 0, "label": 300 % 256}),
                ("283 00 00 00 20 00 00 83 2C", "Node3_SecondState", {"current_phase": 45}),
                ("203 0F 00 00 00 00 20", "Node3_Command", {"controlword": "Enable operation", "target_position": 45}),
                ("383 EE 1F 5E 01 1F 00", "Node3_Monitoring",
                 {"actual_angle": 44.9, "current_actual_value": 350, "temperature": 31, "error_register": 0}),
                ("083 10 23 03 00 00 00 00 00", "Node3_Emergency",
                 {"code": "over-current", "error_register": 3, "detail": 0}),
                ("083 40 81 11 1F 00 00 00 00", "Node3_Emergency", {"code": "back after bus-off", "detail": 31}),
                ("603 23 80 40 01 8E E3 38 0E", "Node3_SdoRequest",
                 {"specifier": "Initiate download", "download_index": 0x4080, "download_sub": 1,
                  "download_data": 0x0E38E38E}),
                ("583 80 80 40 01 31 00 09 06", "Node3_SdoAnswer",
                 {"specifier": "Abort", "abort_index": 0x4080, "abort_sub": 1,
                  "abort_code": "value above the maximum"}),
                ("583 00 50 72 6F 6C 65 67 20", "Node3_SdoAnswer",
                 {"specifier": "Upload segment", "upload_segment_data": int.from_bytes(b"Proleg ", "little")}),
                ("7E5 51 4C 4F 52 50 00 00 01", "LssRequest",
                 {"service": "Fastscan", "fastscan_number": 0x50524F4C, "fastscan_bit": 0, "fastscan_sub": 0,
                  "fastscan_next": 1}),
                ("7E5 11 03 00 00 00 00 00 00", "LssRequest", {"service": "Configure node id", "node_id": 3}),
                ("7E4 17 00 00 00 00 00 00 00", "LssAnswer",
                 {"service": "Store configuration", "store_configuration_error": "accepted"}),
        ):
            with self.subTest(frame=frame):
                self.assertEqual(decoded[frame][0], name)
                for signal, value in expected.items():
                    found = decoded[frame][1][signal]
                    if isinstance(value, str):
                        self.assertEqual(found, value)
                    else:
                        self.assertAlmostEqual(found, value, delta=0.006 if isinstance(value, float) else 1e-6)

    def test_units_and_states_are_given(self):
        dbc = Dbc(self.documented())
        units = {(message.name.split("_")[-1], signal.name): signal.unit
                 for message in dbc.messages.values() for signal in message.signals.values() if signal.unit}
        self.assertEqual(units, {
            ("State", "current_phase"): "deg", ("SecondState", "current_phase"): "deg",
            ("Command", "target_position"): "deg", ("Monitoring", "actual_angle"): "deg",
            ("Monitoring", "current_actual_value"): "mA", ("Monitoring", "temperature"): "degC",
            ("LssRequest", "switch_delay"): "ms"})
        # CiA 402, state coding, with voltage enabled (bit 4) and remote (bit 9).
        self.assertEqual(dbc.tables["statusword"],
                         {0x250: "Switch on disabled", 0x231: "Ready to switch on", 0x233: "Switched on",
                          0x237: "Operation enabled", 0x217: "Quick stop active", 0x218: "Fault"})
        self.assertEqual(dbc.signal(0x383, "actual_angle").values, {-32768: "not measured"})
        codes = dbc.signal(0x083, "code").values
        self.assertTrue({0x0000, 0x2310, 0x3220, 0x4210, 0x8130, 0x8700, 0xFF01, 0xFF06} <= set(codes))
        self.assertEqual((dbc.signal(0x203, "target_position").low, dbc.signal(0x203, "target_position").high), (-90, 90))

    def test_all_node_ids_have_messages_if_asked_for(self):
        dbc = Dbc(self.proleg("objects", "--dbc", "--nodes", 126))
        for base in (0x080, 0x180, 0x200, 0x280, 0x380, 0x580, 0x600, 0x700):
            self.assertTrue(all(base + node in dbc.messages for node in range(1, 127)))
        self.assertEqual(len(dbc.messages), 7 + 126 * 8)
        self.assertEqual(self.proleg("objects", "--dbc"), self.documented(), "write it again")

    def test_a_log_is_decoded_to_what_the_recording_has(self):
        scenario = self.scenario("travelling_wave/coupled")
        dbc = Dbc(self.proleg("objects", "--dbc", scenario))
        self.assertEqual(dbc.nodes, ["Host", "J5", "J4", "J3", "J2", "J1"])
        self.assertNotIn(0x281, dbc.messages, "no joint has a second slot")
        with tempfile.TemporaryDirectory() as folder:
            log, recording = Path(folder, "bus.log"), Path(folder, "run.proleg")
            self.proleg("hil", scenario, "--seconds", 6, "--record", recording, "--can-log", log, "--set",
                        "amplitude=30@200", "--reset", "J3@100", "--send", "603#4034120000000000@50")
            frames = list(read_log(log.read_text(encoding="ascii")))
            table = csv.DictReader(io.StringIO(self.proleg("export", recording, "--out", "-")), delimiter="\t")
            rows = {int(row["tick"]): row for row in table}
        tick, seen, compared, settled = -1, {}, 0, 0
        for identifier, data in frames:
            name, values = dbc.decode(identifier, data)
            seen.setdefault(name, []).append(values)
            if name == "Sync":
                tick += 1
                self.assertEqual(values["counter"], tick % 128 + 1)
            elif name == "Tick":
                self.assertIn(values["tick"], (tick + 1, 0))
            elif name.endswith("_State"):
                self.assertEqual(values["label"], (tick + 1) % 256)
                joint, row = name.removesuffix("_State"), rows.get(tick)
                if row is None:
                    continue  # state 0, before SYNC 0; or after the last tick of the recording
                self.assertAlmostEqual(values["current_phase"], float(row[f"current_phase_deg.{joint}"]), delta=1e-6)
                amplitude = values["current_amplitude"]
                self.assertAlmostEqual(amplitude, float(row[f"current_amplitude_deg.{joint}"]), delta=90 / 2 ** 15 + 1e-6)
                compared += 1
                if tick > 450:  # without an offset: the set-point is amplitude * cos(phase)
                    angle = amplitude * math.cos(math.radians(values["current_phase"]))
                    self.assertAlmostEqual(angle, float(row[f"setpoint_deg.{joint}"]), delta=0.01)
                    settled += 1
        self.assertEqual(tick, 600 if len(seen["Sync"]) == 601 else 599)
        self.assertGreater(compared, 5 * 600 - 40)
        self.assertGreater(settled, 5 * 140)
        self.assertEqual(seen["Nmt"][-1], {"command": "Start", "node": 3}, "after its reset")
        self.assertIn({"command": "Start", "node": "all"}, seen["Nmt"])
        self.assertEqual({commit["tick"] for commit in seen["Commit"]}, {200})
        self.assertEqual([state["state"] for state in seen["J3_Heartbeat"]].count("Boot-up"), 2)
        self.assertEqual(seen["J3_Heartbeat"][-1]["state"], "Operational")
        self.assertEqual([emergency["code"] for emergency in seen["J3_Emergency"]][-1],
                         "joined the moving robot again")
        self.assertIn("no such object", [answer.get("abort_code") for answer in seen["J3_SdoAnswer"]])
        self.assertTrue(all(10 < values["temperature"] < 60 for values in seen["J1_Monitoring"]))
        writes = [request.get("download_data") for request in seen["J1_SdoRequest"]
                  if request.get("download_index") == 0x6040]
        self.assertEqual(writes, [6, 7, 15])

    def changed_robot(self, folder, change):
        """The DBC file of the shipped robot with changed XML files, which are put into the folder."""
        robots = self.source / "sim/scenarios/travelling_wave"
        for file in robots.rglob("*.xml"):
            target = Path(folder) / file.relative_to(robots)
            target.parent.mkdir(exist_ok=True)
            target.write_text(change(file.read_text(encoding="utf-8")), encoding="utf-8")
        return Dbc(self.proleg("objects", "--dbc", Path(folder, "coupled.simulation.xml")))

    def test_names_of_joints_become_identifiers_that_differ(self):
        for names, nodes in (
                (["Hip", "knee-2", "3rd", "a b", "last"], ["Host", "last", "a_b", "n3rd", "knee_2", "Hip"]),
                (["Hip", "hip", "host", "x" * 40, "x" * 41],
                 ["Host", f"{'x' * 16}_1", f"{'x' * 16}_2", "host_3", "hip_4", "Hip_5"])):
            with self.subTest(names=names), tempfile.TemporaryDirectory() as folder:
                dbc = self.changed_robot(folder, lambda text, names=names: re.sub(
                    '<Joint name="J([1-5])"', lambda match: f'<Joint name="{names[int(match[1]) - 1]}"', text))
                self.assertEqual(dbc.nodes, nodes)
                self.assertIn(names[0], dbc.node_comments[nodes[5]])

    def test_a_frame_has_the_values_that_the_algorithms_of_its_joint_broadcast(self):
        second = """<actuationModule name="PatternGenerator_sinusoidal"><jointConfiguration joints="00011"/>
                    </actuationModule>"""
        with tempfile.TemporaryDirectory() as folder:
            dbc = self.changed_robot(folder, lambda text: text.replace("</actuationModule>", "</actuationModule>" + second))
        self.assertTrue({"current_phase", "current_amplitude"} <= set(dbc.messages[0x181].signals))
        self.assertIn("contact_far_link_front", dbc.messages[0x181].signals)
        self.assertNotIn("contact_far_link_front", dbc.messages[0x182].signals, "of the joint at the head only")
        self.assertEqual([message.name for message in dbc.messages.values() if message.name.endswith("_SecondState")],
                         ["J5_SecondState", "J4_SecondState"])
        self.assertIn("current_phase", dbc.messages[0x282].signals)
        self.assertNotIn("current_amplitude", dbc.messages[0x282].signals, "the sine broadcasts its phase only")

    def test_the_reader_finds_what_is_wrong(self):
        text = self.documented()
        for pattern, replacement in (
                (r"VERSION .*\n", "VERSION protocol\n"),
                (r"BU_: Host", "BU_: host-1"),
                (r"BU_: Host ", "BU_: Host Node1 "),
                (r"BU_: Host ", "BU_: "),
                (r"BO_ 128 Sync", "BO_ 0 Sync"),
                (r"BO_ 128 Sync", "BO_ 128 NMT"),
                (r"BO_ 128 Sync", "BO_ 128 " + "x" * 33),
                (r"BO_ 128 Sync: 1", "BO_ 128 Sync: 0"),
                (r"SG_ tick : 0\|32", "SG_ tick : 1|32"),
                (r"SG_ tick : 0\|32@1", "SG_ tick : 0|32@0"),
                (r"SG_ tick : 0\|32", "SG_ configuration_CRC : 0|32"),
                (r"SG_ tick ", "SG_ double "),
                (r"SG_ tick : 0\|32@1\+ \(1,0\)", "SG_ tick : 0|32@1+ (0,0)"),
                (r"\[0\|4294967295\]", "[0|4294967296]"),
                (r"\[0\|4294967295\]", "[5|5]"),
                (r"\|8@1\+ \(1,0\) \[0\|255\] \"\" Vector__XXX", '|8@1+ (1,0) [0|255] "" Nobody'),
                (r" SG_ service M ", " SG_ service "),
                (r" SG_ state m4 ", " SG_ state m5 "),
                (r"CM_ BO_ 128 \"[^\"]*\";\n", ""),
                (r"CM_ BO_ 128 ", "CM_ BO_ 129 "),
                (r"CM_ SG_ 128 counter", "CM_ SG_ 128 count"),
                (r"VAL_ 0 command 1 \"Start\"", 'VAL_ 0 command 1 "Start" 1 "Go"'),
                (r"VAL_ 0 command 1 \"Start\"", 'VAL_ 0 command 256 "Start"'),
                (r"VAL_ 0 command 1 \"Start\"", "VAL_ 0 command 1 Start"),
                (r"VAL_ 0 command", "VAL_ 0 commands"),
                (r"CM_ \"", "BS_:\nCM_ \""),
        ):
            with self.subTest(pattern=pattern, replacement=replacement):
                wrong, count = re.subn(pattern, replacement, text, count=1)
                self.assertEqual(count, 1)
                with self.assertRaises(Malformed):
                    Dbc(wrong)


if __name__ == "__main__":
    DbcTest.programs = Path(sys.argv.pop()).resolve()
    DbcTest.source = Path(sys.argv.pop()).resolve()
    unittest.main()
