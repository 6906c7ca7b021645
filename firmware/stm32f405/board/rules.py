"""What must be true of the tables: rules of the chip's data sheet and of this project. Each rule yields one line for each fault."""

import re
from pathlib import Path

from tables import QUESTIONS, TWO_PINS

FIRMWARE_FOLDER = Path(__file__).resolve().parent.parent
PINS_HPP = FIRMWARE_FOLDER / "pins.hpp"
PROFILE = FIRMWARE_FOLDER / "boards/reference.hpp"
CHIP, GROUND, LOGIC, ANALOG = "U1", "GND", "3V3", "VDDA"
# Greatest voltage at a pin (data sheet, general operating conditions and I/O static characteristics, with VDD at 3.3 V).
PIN_VOLTS = {"FT": 5.5, "TTa": 3.6, "RST": 3.6, "B": 3.6, "-": 3.6}
ANALOG_VOLTS = 3.6  # an FT pin is not 5 V tolerant while it is analog
# The pins of the profile: function in the chip, constant of pins.hpp with the number of the alternate function, and where the
# signal must arrive, through resistors in series and the buffer.
FIRMWARE = {
    "can_receive": ("CAN1_RX", "can_function", "U2.4"),
    "can_transmit": ("CAN1_TX", "can_function", "U2.1"),
    "servo": ("TIM2_CH1", "servo_function", "J3.3"),
    "contacts[0]": ("GPIO", None, "J4.2"),
    "contacts[1]": ("GPIO", None, "J4.3"),
    "contacts[2]": ("GPIO", None, "J4.4"),
    "contacts[3]": ("GPIO", None, "J4.5"),
    "servo_supply": ("GPIO", None, "Q3.1"),
    "servo_current": ("ADC123_IN", None, "U4.1"),
    "feedback": ("ADC123_IN", None, "J5.2"),
    "console_transmit": ("USART2_TX", "console_function", "J6.2"),
    "console_receive": ("USART2_RX", "console_function", "J6.3"),
    "led": ("GPIO", None, "D3.2"),
    "recover_button": ("GPIO", None, "SW3.1"),
}


def microfarads(part):
    match = re.fullmatch(r"([\d.]+) ([nµp])F", part.value)
    return float(match[1]) * {"p": 1e-6, "n": 1e-3, "µ": 1}[match[2]] if match else 0


def ohms(part):
    match = re.fullmatch(r"([\d.]+) ([mk]?)Ω", part.value)
    return float(match[1]) * {"m": 1e-3, "": 1, "k": 1e3}[match[2]] if match else 0


def between(board, symbols, one, other):
    """The parts with two pins that lie between two nets."""
    for part in board.parts.values():
        if part.symbol in symbols and len(part.pins) == 2:
            names = {pin.net.name for pin in part.pins if pin.net}
            if names == {one, other}:
                yield part


def has_resistor(board, one, other, lowest, highest):
    return any(lowest <= ohms(part) <= highest for part in between(board, ("resistor",), one, other))


def parts_have_their_pins(board):
    for part in board.parts.values():
        if not part.pins:
            yield f"{part.name}: found no pins in netlist.tsv, expected all of them"
        wanted = TWO_PINS.get(part.symbol)
        if wanted and tuple(pin.name for pin in part.pins) != wanted:
            yield f"{part.name}: found pins {', '.join(pin.name for pin in part.pins)}, expected {', '.join(wanted)} of a {part.symbol}"
        numbers = [int(pin.number) for pin in part.pins]
        if numbers != list(range(1, len(numbers) + 1)):
            yield f"{part.name}: found pins {', '.join(pin.number for pin in part.pins)}, expected all from 1 on, in order"


def pins_are_connected_or_say_why_not(board):
    for pin in board.pins:
        if pin.type == "no_connect" and pin.net:
            yield f"{pin}: found net {pin.net.name}, expected none: its type is no_connect"
        elif pin.type != "no_connect" and not pin.net:
            yield f"{pin}: found no net, expected one, or the type no_connect"
        elif pin.type == "no_connect" and pin.why == "-":
            yield f"{pin}: found no reason, expected why it is not connected"


def nets_have_two_pins(board):
    for net in board.nets.values():
        if len(net.pins) < 2:
            yield f"net {net.name}: found {len(net.pins)} pins, expected at least two"


def nets_have_one_driver(board):
    for net in board.nets.values():
        drivers = [pin for pin in net.pins if pin.type in ("output", "power_out")]
        if len(drivers) > 1:
            yield f"net {net.name}: found drivers {' and '.join(map(str, drivers))}, expected one"


def inputs_are_driven(board):
    for net in board.nets.values():
        if net.pins and all(pin.type in ("input", "power_in") for pin in net.pins):
            yield f"net {net.name}: found only inputs, expected something that drives it"


def voltages_are_allowed(board):
    for pin in board.pins:
        if not pin.net:
            continue
        allowed = pin.volts
        if pin.part.name == CHIP:
            fact = board.package.get(pin.number)
            allowed = PIN_VOLTS[fact.structure] if fact else pin.volts
            if pin.function.startswith("ADC"):
                allowed = min(allowed, ANALOG_VOLTS)
        if pin.net.volts > allowed:
            yield f"{pin}: found {pin.net.volts:g} V of net {pin.net.name}, expected at most {allowed:g} V"


def polarity_is_right(board):
    for part in board.parts.values():
        if len(part.pins) != 2 or not all(pin.net for pin in part.pins):
            continue
        first, second = (pin.net.name for pin in part.pins)
        if first == second:
            yield f"{part.name}: found both pins on net {first}, expected two nets"
        if part.symbol in ("polarised", "tvs", "schottky") and first == GROUND:
            yield f"{part.name}: found pin {part.pins[0].name} on {GROUND}, expected pin {part.pins[1].name} there"


def chip_is_the_package(board):
    if CHIP not in board.parts:
        yield f"{CHIP}: found no such part, expected the chip"
        return
    pins = {pin.number: pin for pin in board.parts[CHIP].pins}
    for number, fact in board.package.items():
        pin = pins.get(number)
        if not pin:
            yield f"{CHIP}.{number}: found no row in netlist.tsv, expected {fact.name}"
        elif pin.name != fact.name:
            yield f"{pin}: found name {pin.name}, expected {fact.name}"
        elif fact.functions and pin.function not in fact.functions:
            yield f"{pin}: found function {pin.function}, expected one of {', '.join(fact.functions)}"
        elif not fact.functions and pin.function != "-":
            yield f"{pin}: found function {pin.function}, expected none"
        elif fact.type == "S" and not pin.net:
            yield f"{pin}: found no net, expected one: it is a supply"
    for number in pins.keys() - board.package.keys():
        yield f"{pins[number]}: found a pin that the package does not have"


def chip_pins(board, *names):
    return [pin for pin in board.parts[CHIP].pins if pin.name in names and pin.net] if CHIP in board.parts else []


def supplies_of_the_chip(board):
    for names, wanted in ((("VDD", "VBAT"), LOGIC), (("VSS", "VSSA"), GROUND), (("VDDA",), ANALOG)):
        for pin in chip_pins(board, *names):
            if pin.net.name != wanted:
                yield f"{pin}: found net {pin.net.name}, expected {wanted}"
    if not list(between(board, ("ferrite",), LOGIC, ANALOG)):
        yield f"net {ANALOG}: found no ferrite bead to {LOGIC}, expected one"
    for pin in chip_pins(board, "VCAP_1", "VCAP_2"):
        others = [other.part for other in pin.net.pins if other is not pin]
        if len(others) != 1 or others[0].symbol != "capacitor" or microfarads(others[0]) != 2.2 or \
                {other.net.name for other in others[0].pins if other.net} != {pin.net.name, GROUND}:
            yield f"{pin}: found {', '.join(part.name for part in others) or 'nothing'}, expected one capacitor of 2.2 µF to {GROUND}"
    for pin in chip_pins(board, "BOOT0", "PB2"):
        if not has_resistor(board, pin.net.name, GROUND, 1e3, 1e4):
            yield f"{pin}: found no pull-down, expected 1 to 10 kΩ to {GROUND}"
    for pin in chip_pins(board, "NRST"):
        if not any(microfarads(part) == 0.1 for part in between(board, ("capacitor",), pin.net.name, GROUND)):
            yield f"{pin}: found no capacitor, expected 100 nF to {GROUND}"
    crystals = [part for part in board.parts.values() if part.symbol == "crystal"]
    wanted = {pin.net.name for pin in chip_pins(board, "PH0", "PH1")}
    if [{pin.net.name for pin in part.pins if pin.net} for part in crystals] != [wanted]:
        yield f"{CHIP}: found no crystal between PH0 and PH1, expected one"
    for name in sorted(wanted):
        if len(list(between(board, ("capacitor",), name, GROUND))) != 1:
            yield f"net {name}: found no load capacitor, expected one to {GROUND}"


def supplies_have_capacitors(board):
    """Each supply pin has a capacitor to ground beside it."""
    for pin in board.pins:
        if pin.type != "power_in" or not pin.net or pin.net.name == GROUND:
            continue
        beside = [part for part in between(board, ("capacitor",), pin.net.name, GROUND)
                  if part.near == f"{pin.part.name}.{pin.number}"]
        if not beside:
            yield f"{pin}: found no capacitor from {pin.net.name} to {GROUND} near it, expected one"


def near_is_on_the_same_net(board):
    for part in board.parts.values():
        if part.near == "-":
            continue
        pin = board.pin(part.near)
        if not pin:
            yield f"{part.name}: found near {part.near}, expected a pin of the board"
        elif pin.net not in [own.net for own in part.pins]:
            yield f"{part.name}: found near {part.near}, expected a pin on one of its nets"


def connectors_agree(board):
    wanted = [pin.net.name if pin.net else "-" for pin in board.parts["J1"].pins] if "J1" in board.parts else []
    found = [pin.net.name if pin.net else "-" for pin in board.parts["J2"].pins] if "J2" in board.parts else []
    if wanted != found:
        yield f"J2: found pins {', '.join(found)}, expected those of J1: {', '.join(wanted)}"
    for name in ("J1", "J2", "J3", "J4", "J5", "J6"):
        pin = board.pin(f"{name}.1")
        if not pin or not pin.net or pin.net.name != GROUND:
            yield f"{name}.1: found {pin.net.name if pin and pin.net else 'no net'}, expected {GROUND}"
    if wanted and wanted[-1] != GROUND:
        yield f"J1.{len(wanted)}: found {wanted[-1]}, expected {GROUND}, as at the other end"


def lines_have_their_state_in_a_reset(board):
    """What floating pins of the chip must not decide."""
    for name, rail, highest, why in (("U2.1", LOGIC, 1e5, "recessive"), ("U5.2", GROUND, 1e4, "no pulse"),
                                     ("Q3.1", GROUND, 1e5, "servo off")):
        pin = board.pin(name)
        if not pin or not pin.net or not has_resistor(board, pin.net.name, rail, 1e3, highest):
            yield f"{pin or name}: found no resistor to {rail}, expected one: {why} while the chip is in reset"
    for name in ("U2.5", "U2.8"):
        pin = board.pin(name)
        if not pin or not pin.net or pin.net.name != GROUND:
            yield f"{pin or name}: found {pin.net.name if pin and pin.net else 'no net'}, expected {GROUND}: no program drives it"


def questions_are_answered(board):
    answered = {answer for part in board.parts.values() for answer in part.answers}
    for question in QUESTIONS:
        if question not in answered:
            yield f"{question}: found no part that answers it, expected one"


def reachable(board, net):
    """The pins that a signal reaches through resistors between two signals, and through the buffer U5."""
    nets, reached = [net], []
    rails = (GROUND, LOGIC, ANALOG)
    for net in nets:
        for pin in net.pins:
            reached.append(f"{pin.part.name}.{pin.number}")
            onward = []
            if pin.part.symbol == "resistor":
                onward = [other.net for other in pin.part.pins if other is not pin]
            elif pin.part.name == "U5" and pin.name in "AY":
                onward = [other.net for other in pin.part.pins if other.name in "AY"]
            nets += [other for other in onward if other and other.name not in rails and other not in nets]
    return reached


def read_profile(path):
    """The pins that the profile of the reference board declares."""
    text = path.read_text()
    pins = {name: f"P{port}{number}"
            for name, port, number in re.findall(r"\.(\w+) = (?:Pin|Switch\{)?\{'([A-I])', (\d+)\}", text)}
    for name, body in re.findall(r"\.(\w+) = \{\{(\{.*?\})\}\},", text):
        for index, (port, number) in enumerate(re.findall(r"\{'([A-I])', (\d+)\}", body)):
            pins[f"{name}[{index}]"] = f"P{port}{number}"
    return pins


def read_functions(path):
    """The numbers of the alternate functions that pins.hpp declares."""
    return {name: int(number) for name, number in re.findall(r"constexpr unsigned (\w+) = (\d+);", path.read_text())}


def firmware_finds_its_signals(board, path=PROFILE, functions_path=PINS_HPP):
    pins, numbers = read_profile(path), read_functions(functions_path)
    for name in sorted(FIRMWARE.keys() - pins.keys()):
        yield f"{path.name}: found no pin {name}, expected it"
    for name in sorted(pins.keys() - FIRMWARE.keys()):
        yield f"{path.name}: found pin {name}, expected one that FIRMWARE of rules.py knows"
    for name in sorted(FIRMWARE.keys() & pins.keys()):
        function, constant, target = FIRMWARE[name]
        pin = next((pin for pin in chip_pins(board, pins[name])), None)
        if not pin:
            yield f"{pins[name]}: found no net, expected the signal {name} of {path.name}"
            continue
        alternate = board.package[pin.number].functions if pin.number in board.package else {}
        # analog_channel_of() of boards/profile.hpp: PC0 is channel 10.
        wanted = f"{function}{10 + int(pins[name][2:])}" if function.startswith("ADC") else function
        if pin.function != wanted:
            yield f"{pin}: found function {pin.function}, expected {wanted} of {name} in {path.name}"
        elif constant and alternate.get(function) != numbers.get(constant):
            yield f"{pin}: found alternate function {numbers.get(constant)} in {functions_path.name}, expected {alternate.get(function)} for {function}"
        if pin.program != "now":
            yield f"{pin}: found program {pin.program}, expected now: {path.name} has it as {name}"
        if target not in reachable(board, pin.net):
            yield f"{pin}: found no way to {target}, expected one for {name} of {path.name}"
    for pin in board.parts[CHIP].pins if CHIP in board.parts else []:
        if pin.program == "later" and pin.name in pins.values():
            yield f"{pin}: found program later, expected now: {path.name} has it"


RULES = (parts_have_their_pins, pins_are_connected_or_say_why_not, nets_have_two_pins, nets_have_one_driver, inputs_are_driven,
         voltages_are_allowed, polarity_is_right, chip_is_the_package, supplies_of_the_chip, supplies_have_capacitors,
         near_is_on_the_same_net, connectors_agree, lines_have_their_state_in_a_reset, questions_are_answered,
         firmware_finds_its_signals)


def faults(board):
    return [fault for rule in RULES for fault in rule(board)]
