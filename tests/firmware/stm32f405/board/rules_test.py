"""The tables of the reference module against its profile, pins.hpp, the package and the rules of the board; and planted faults, each of which is
found and named."""

import re
import sys
import unittest

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
from board_tables import FOLDER, Copy, run, seeded  # noqa: E402

import pages  # noqa: E402
import rules  # noqa: E402
import schematic  # noqa: E402
import tables  # noqa: E402

PINS_HPP = FOLDER.parent / "pins.hpp"
PROFILE = FOLDER.parent / "boards/reference.hpp"


class Board(unittest.TestCase):
    def setUp(self):
        self.board = tables.read_board(FOLDER)

    def net(self, pin):
        return self.board.pin(pin).net.name

    def test_has_no_fault(self):
        self.assertEqual(rules.faults(self.board), [])

    def test_package_is_that_of_the_data_sheet(self):
        """DS8626, table 7: numbers of supply pins and of the pins that are not 5 V tolerant, typed from it by hand."""
        numbers = {}
        for number, pin in self.board.package.items():
            numbers.setdefault(pin.name, []).append(int(number))
        self.assertEqual(len(self.board.package), 64)
        self.assertEqual({name: numbers[name] for name in ("VDD", "VSS", "VSSA", "VDDA", "VBAT", "VCAP_1", "VCAP_2", "NRST", "BOOT0")},
                         {"VDD": [19, 32, 48, 64], "VSS": [18, 63], "VSSA": [12], "VDDA": [13], "VBAT": [1], "VCAP_1": [31],
                          "VCAP_2": [47], "NRST": [7], "BOOT0": [60]})
        self.assertEqual({pin.name for pin in self.board.package.values() if pin.structure == "TTa"}, {"PA4", "PA5"})
        self.assertEqual({name: numbers[name] for name in ("PB8", "PB9", "PA5", "PC0", "PC1", "PA2", "PA3", "PB12", "PB15", "PB2")},
                         {"PB8": [61], "PB9": [62], "PA5": [21], "PC0": [8], "PC1": [9], "PA2": [16], "PA3": [17], "PB12": [33],
                          "PB15": [36], "PB2": [28]})

    def test_all_pins_of_the_profile_are_read(self):
        pins = rules.read_profile(PROFILE)
        self.assertEqual(len(re.findall(r"\{'[A-Z]', \d+\}", PROFILE.read_text())), len(pins))
        self.assertEqual(pins["servo"], "PA5")
        self.assertEqual(pins["contacts[3]"], "PB15")
        self.assertEqual(rules.read_functions(PINS_HPP)["can_function"], 9)

    def test_spare_pins_are_for_a_later_program(self):
        later = {pin.name: pin.net.name for pin in self.board.parts["U1"].pins if pin.program == "later"}
        self.assertEqual(later, {"PC2": "SUPPLY_SENSE", "PC3": "SERVO_TEMPERATURE", "PC8": "REV0",
                                 "PC9": "REV1", "PA8": "MCO"})

    def test_current_is_1_v_per_a(self):
        self.assertAlmostEqual(rules.ohms(self.board.parts["R30"]) * 50, 1)
        self.assertIn("50 V/V", self.board.parts["U4"].article)

    def test_store_holds_a_pulse_between_detector_and_brown_out(self):
        """At 100 mA, from 2.93 to 2.83 V (typical), with the least capacity: at least the longest pulse, 2.5 ms."""
        store = sum(rules.microfarads(part) for part in rules.between(self.board, ("polarised",), "VLOGIC", "GND")) * 1e-6
        self.assertGreater(0.8 * store * (2.93 - 2.83) / 0.1, 2.5e-3)

    def test_load_of_the_crystal(self):
        for name in ("C20", "C21"):
            self.assertAlmostEqual(rules.microfarads(self.board.parts[name]) * 1e6, 2 * (10 - 4))

    def test_servo_line_against_a_pull_up_in_the_servo(self):
        series = rules.ohms(self.board.parts["R39"])
        self.assertLess(5 * series / (series + 4700), 0.8)

    def test_supply_sense_is_within_the_adc_also_when_d1_clamps(self):
        high, low = (rules.ohms(self.board.parts[name]) for name in ("R3", "R4"))
        self.assertLess(15.4 * low / (high + low), 3.3)

    def test_plugging_in_does_not_switch_the_servo_on(self):
        """The gate of Q2 follows by the ratio of its two capacitors: less than the least threshold, 1 V."""
        slope, gate = (rules.microfarads(self.board.parts[name]) for name in ("C32", "C33"))
        self.assertLess(8.4 * slope / (slope + gate), 1)

    def test_straps_say_revision_1_as_the_profile_does(self):
        revision = int(re.search(r"\.revision = (\d+),", PROFILE.read_text())[1])
        straps = [any({self.net(f"{part.name}.1"), self.net(f"{part.name}.2")} == {net, "3V3"} for part in self.board.parts.values()
                      if part.symbol == "resistor") for net in ("REV0", "REV1")]
        self.assertEqual(sum(1 << bit for bit, high in enumerate(straps) if high), revision)


# What is planted, and what a line of the rules must say.
PLANTED = {
    "CAN lines of the chip exchanged": (lambda copy: (copy.set_pin("U1.61", net="CAN_TX"), copy.set_pin("U1.62", net="CAN_RX")),
                                        r"U1\.61 \(PB8\): found no way to U2\.4"),
    "servo on a pin that has no TIM2_CH1": (lambda copy: (copy.set_pin("U1.21", net="-", type="no_connect", function="GPIO"),
                                                          copy.set_pin("U1.22", net="SERVO_PULSE", type="output", function="GPIO")),
                                            r"PA5: found no net, expected the signal servo"),
    "wrong function": (lambda copy: copy.set_pin("U1.21", function="TIM8_CH1N"), r"U1\.21 \(PA5\): found function TIM8_CH1N, expected TIM2_CH1"),
    "function that the pin does not have": (lambda copy: copy.set_pin("U1.21", function="CAN1_RX"),
                                            r"U1\.21 \(PA5\): found function CAN1_RX, expected one of"),
    "wrong alternate function in the facts": (lambda copy: copy.set("lqfp64.tsv", {"pin": "61"}, functions="GPIO CAN1_RX=8"),
                                              r"U1\.61 \(PB8\): found alternate function 9 in pins\.hpp, expected 8"),
    "touch sensors exchanged": (lambda copy: (copy.set_pin("J4.2", net="TOUCH_2"), copy.set_pin("J4.3", net="TOUCH_1")),
                                r"U1\.33 \(PB12\): found no way to J4\.2"),
    "used pin marked as later": (lambda copy: copy.set_pin("U1.8", program="later"), r"U1\.8 \(PC0\): found program later, expected now"),
    "VDD on another net": (lambda copy: copy.set_pin("U1.32", net="VDDA"), r"U1\.32 \(VDD\): found net VDDA, expected 3V3"),
    "VSS not connected": (lambda copy: copy.set_pin("U1.18", net="-", type="no_connect", why="mistake"),
                          r"U1\.18 \(VSS\): found no net, expected one: it is a supply"),
    "VBAT on ground": (lambda copy: copy.set_pin("U1.1", net="GND"), r"U1\.1 \(VBAT\): found net GND, expected 3V3"),
    "no capacitor at VCAP_2": (lambda copy: copy.remove_part("C16"), r"U1\.47 \(VCAP_2\): found nothing, expected one capacitor"),
    "load on VCAP_1": (lambda copy: copy.set_pin("TP9.1", net="VCAP_1"), r"U1\.31 \(VCAP_1\): found C15, TP9, expected one capacitor"),
    "VCAP of 100 nF": (lambda copy: copy.set("parts.tsv", {"part": "C15"}, value="100 nF"), r"U1\.31 \(VCAP_1\): found C15, expected"),
    "BOOT0 floats": (lambda copy: copy.remove_part("R7"), r"U1\.60 \(BOOT0\): found no pull-down"),
    "BOOT1 pulled too weakly": (lambda copy: copy.set("parts.tsv", {"part": "R9"}, value="100 kΩ"), r"U1\.28 \(PB2\): found no pull-down"),
    "NRST without capacitor": (lambda copy: copy.remove_part("C22"), r"U1\.7 \(NRST\): found no capacitor"),
    "VDD without capacitor": (lambda copy: copy.remove_part("C12"), r"U1\.48 \(VDD\): found no capacitor from 3V3 to GND near it"),
    "capacitor far away": (lambda copy: copy.set("parts.tsv", {"part": "C12"}, near="U1.8"), r"C12: found near U1\.8, expected a pin on one of its nets"),
    "VDDA without bead": (lambda copy: copy.set_pin("FB1.1", net="VLOGIC"), r"net VDDA: found no ferrite bead to 3V3"),
    "crystal at one pin": (lambda copy: copy.set_pin("Y1.2", net="GND"), r"U1: found no crystal between PH0 and PH1"),
    "crystal without load": (lambda copy: copy.remove_part("C21"), r"net HSE_OUT: found no load capacitor"),
    "5 V at a pin that is not tolerant": (lambda copy: copy.set_pin("U1.21", net="SERVO_SIGNAL"),
                                          r"U1\.21 \(PA5\): found 5 V of net SERVO_SIGNAL, expected at most 3\.6 V"),
    "5 V at an analog input": (lambda copy: copy.set("nets.tsv", {"net": "FEEDBACK"}, volts="5"),
                               r"U1\.9 \(PC1\): found 5 V of net FEEDBACK, expected at most 3\.6 V"),
    "bus supply at the transceiver": (lambda copy: copy.set_pin("U2.3", net="VPROT"), r"U2\.3 \(VCC\): found 15\.4 V of net VPROT, expected at most 3\.6"),
    "capacitor of too few volts": (lambda copy: copy.set("parts.tsv", {"part": "C1"}, volts="6.3"), r"C1\.1 \(1\): found 15\.4 V of net VPROT"),
    "net with one pin": (lambda copy: copy.set_pin("TP9.1", net="3V3"), r"net MCO: found 1 pins, expected at least two"),
    "net without pins": (lambda copy: copy.append("nets.tsv", "UNUSED", "3.3", "nothing"), r"net UNUSED: found 0 pins"),
    "two drivers": (lambda copy: copy.set_pin("U2.4", net="CAN_TX"), r"net CAN_TX: found drivers U1\.62 \(PB9\) and U2\.4 \(RXD\), expected one"),
    "inputs only": (lambda copy: (copy.set_pin("U1.62", net="-", type="no_connect"), copy.remove_part("R20")), r"net CAN_TX: found"),
    "pin left out": (lambda copy: copy.remove("netlist.tsv", part="U2", pin="8"), r"U2\.8: found no net, expected GND"),
    "pin of the chip left out": (lambda copy: copy.remove("netlist.tsv", part="U1", pin="50"), r"U1\.50: found no row in netlist\.tsv, expected PA15"),
    "gap in the pins": (lambda copy: copy.remove("netlist.tsv", part="U2", pin="4"), r"U2: found pins 1, 2, 3, 5, 6, 7, 8, expected all"),
    "part without pins": (lambda copy: copy.remove("netlist.tsv", part="R30"), r"R30: found no pins"),
    "open pin without a reason": (lambda copy: copy.set_pin("U5.1", why="-"), r"U5\.1 \(NC\): found no reason"),
    "no net and no mark": (lambda copy: copy.set_pin("U5.2", net="-"), r"U5\.2 \(A\): found no net, expected one, or the type no_connect"),
    "mark and net": (lambda copy: copy.set_pin("U5.1", net="GND"), r"U5\.1 \(NC\): found net GND, expected none"),
    "pins of the through connector in another order": (lambda copy: (copy.set_pin("J2.3", net="CAN_L"), copy.set_pin("J2.4", net="CAN_H")),
                                                       r"J2: found pins GND, VBUS, CAN_L, CAN_H, VBUS, GND, expected those of J1"),
    "ground not at pin 1": (lambda copy: (copy.set_pin("J3.1", net="VSERVO"), copy.set_pin("J3.2", net="GND")), r"J3\.1: found VSERVO, expected GND"),
    "electrolytic capacitor reversed": (lambda copy: (copy.set_pin("C3.1", net="GND"), copy.set_pin("C3.2", net="VLOGIC")), r"C3: found pin \+ on GND"),
    "diode reversed": (lambda copy: (copy.set_pin("D7.1", net="GND"), copy.set_pin("D7.2", net="VSERVO")), r"D7: found pin K on GND"),
    "part shorted": (lambda copy: copy.set_pin("R33.2", net="VSHUNT"), r"R33: found both pins on net VSHUNT"),
    "transmit line floats in a reset": (lambda copy: copy.remove_part("R20"), r"U2\.1 \(TXD\): found no resistor to 3V3"),
    "pulse line floats in a reset": (lambda copy: copy.set("parts.tsv", {"part": "R38"}, value="100 kΩ"), r"U5\.2 \(A\): found no resistor to GND"),
    "servo switch floats in a reset": (lambda copy: copy.set_pin("R35.2", net="3V3"), r"Q3\.1 \(G\): found no resistor to GND"),
    "standby pin floats": (lambda copy: copy.set_pin("U2.8", net="3V3"), r"U2\.8 \(STB\): found 3V3, expected GND"),
    "question without an answer": (lambda copy: copy.set("parts.tsv", {"answers": "B9"}, answers="B10") or
                                   copy.set("parts.tsv", {"answers": "B9,B10"}, answers="B10"), r"B9: found no part that answers it"),
}


class Planted(unittest.TestCase):
    pass


def planted(change, expected):
    def test(self):
        copy = Copy(self)
        change(copy)
        result = run("check", folder=copy.folder)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertRegex(result.stderr, re.compile("^" + expected, re.MULTILINE))
    return test


for name, (change, expected) in PLANTED.items():
    setattr(Planted, "test_" + name.replace(" ", "_").replace("-", "_"), planted(change, expected))


class RandomChanges(unittest.TestCase):
    def test_are_read_and_judged_or_rejected_and_what_has_no_fault_can_be_drawn(self):
        """Rows that are removed, and cells that come from other rows: each table that can be read gets a verdict."""
        source = seeded(405)
        judged = 0
        for _ in range(150):
            copy = Copy(self)
            for _ in range(source.randint(1, 3)):
                name = source.choice(("nets.tsv", "parts.tsv", "netlist.tsv"))
                lines = copy.lines(name)[:-1]
                first = next(number for number, line in enumerate(lines) if not line.startswith("#")) + 1
                one, other = source.randrange(first, len(lines)), source.randrange(first, len(lines))
                if source.random() < 0.3:
                    del lines[one]
                else:
                    cells = lines[one].split("\t")
                    column = source.randrange(len(cells))
                    cells[column] = lines[other].split("\t")[column]
                    lines[one] = "\t".join(cells)
                (copy.folder / name).write_text("\n".join(lines) + "\n")
            try:
                board = tables.read_board(copy.folder)
            except tables.TableError:
                continue
            judged += 1
            if not rules.faults(board):
                schematic.write(board)
                pages.parts(board)
        self.assertGreater(judged, 50)


class PlantedInTheProfile(unittest.TestCase):
    """What changes in the profile of the board, or in pins.hpp, without the tables."""

    def faults(self, old, new, source=PROFILE):
        copy = Copy(self)
        text = source.read_text()
        self.assertIn(old, text)
        path = copy.folder / source.name
        path.write_text(text.replace(old, new))
        board = tables.read_board(copy.folder)
        paths = {PROFILE: PROFILE, PINS_HPP: PINS_HPP, source: path}
        return "\n".join(rules.firmware_finds_its_signals(board, paths[PROFILE], paths[PINS_HPP]))

    def test_the_servo_moves(self):
        self.assertIn("PA4: found no net, expected the signal servo of reference.hpp", self.faults("servo = {'A', 5}", "servo = {'A', 4}"))

    def test_two_touch_sensors_are_exchanged(self):
        self.assertIn("U1.34 (PB13): found no way to J4.2, expected one for contacts[0]", self.faults("{'B', 12}, {'B', 13}", "{'B', 13}, {'B', 12}"))

    def test_another_alternate_function(self):
        self.assertIn("found alternate function 8 in pins.hpp, expected 7 for USART2_TX",
                      self.faults("console_function = 7", "console_function = 8", PINS_HPP))

    def test_another_analog_pin(self):
        self.assertIn("U1.9 (PC1): found no way to U4.1, expected one for servo_current",
                      self.faults("servo_current = Pin{'C', 0}", "servo_current = Pin{'C', 1}"))

    def test_a_new_pin(self):
        self.assertIn("reference.hpp: found pin beeper, expected one that FIRMWARE of rules.py knows",
                      self.faults(".servo = {'A', 5}", ".beeper = Pin{'A', 4},\n    .servo = {'A', 5}"))


if __name__ == "__main__":
    sys.exit(unittest.main())
