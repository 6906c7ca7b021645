"""The schematic in KiCad 6: KiCad opens it, plots it and exports its netlist, which must be that of the tables. The pins of the
package and of other parts are those of KiCad's libraries, and the pads of each footprint are the pins of its part.

Argument 1, optional: a folder in which the plot stays."""

import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import eeschema  # noqa: E402
from board_tables import FOLDER, run  # noqa: E402
from schematic_test import all_of, one_of, parse  # noqa: E402

import tables  # noqa: E402

PLOTS = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None
SYMBOLS = Path("/usr/share/kicad/symbols")
FOOTPRINTS = Path("/usr/share/kicad/footprints")
# Parts with a symbol in KiCad's libraries: file, symbol; "~" there is a pin without a name.
KNOWN = {"U1": ("MCU_ST_STM32F4", "STM32F405RGTx"), "U2": ("Interface_CAN_LIN", "TCAN334"), "U4": ("Amplifier_Current", "INA180A1"),
         "U5": ("74xGxx", "74LVC1G17"), "Q3": ("Transistor_FET", "BSS138"), "D5": ("Diode", "BAT54S")}
OTHER_NAMES = {"IN+": "+", "IN-": "-", "VS": "V+"}


def packages():
    missing = eeschema.missing_packages()
    missing += [package for package, folder in (("kicad-symbols", SYMBOLS), ("kicad-footprints", FOOTPRINTS)) if not folder.is_dir()]
    return missing


class KiCad(unittest.TestCase):
    def setUp(self):
        self.board = tables.read_board(FOLDER)

    def test_opens_plots_and_exports_the_nets_of_the_tables(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            schematic = folder / "proleg_module.kicad_sch"
            self.assertEqual(run("schematic", schematic).returncode, 0)
            with eeschema.Eeschema(folder, schematic) as editor:
                netlist = parse(editor.export_netlist().read_text())
                plot = editor.plot()
            self.assertEqual(plot.read_bytes()[:5], b"%PDF-")
            if PLOTS:
                PLOTS.mkdir(parents=True, exist_ok=True)
                shutil.copy(plot, PLOTS / plot.name)
        found, alone = {}, set()
        for net in all_of(one_of(netlist, "nets"), "net"):
            name = one_of(net, "name")[1]
            pins = {one_of(node, "ref")[1] + "." + one_of(node, "pin")[1] for node in all_of(net, "node")}
            if name.startswith("unconnected-"):
                alone |= pins
            else:
                found[name] = pins
        self.assertEqual(found, {net.name: {f"{pin.part.name}.{pin.number}" for pin in net.pins} for net in self.board.nets.values()})
        self.assertEqual(alone, {f"{pin.part.name}.{pin.number}" for pin in self.board.pins if not pin.net})
        components = {one_of(part, "ref")[1]: (one_of(part, "value")[1], one_of(part, "footprint")[1])
                      for part in all_of(one_of(netlist, "components"), "comp")}
        self.assertEqual(components, {part.name: (part.value, part.footprint) for part in self.board.parts.values()})

    def test_pins_are_those_of_its_symbols(self):
        for name, (library, symbol) in KNOWN.items():
            with self.subTest(part=name):
                known = next(node for node in all_of(parse((SYMBOLS / f"{library}.kicad_sym").read_text()), "symbol") if node[1] == symbol)
                wanted = {one_of(pin, "number")[1]: one_of(pin, "name")[1] for unit in all_of(known, "symbol") for pin in all_of(unit, "pin")}
                found = {pin.number: pin.name for pin in self.board.parts[name].pins if pin.number in wanted}
                self.assertEqual(found.keys(), wanted.keys())
                for number, text in wanted.items():
                    if text != "~" and name != "D5":
                        self.assertEqual(OTHER_NAMES.get(found[number], found[number]), text, f"{name}.{number}")
                self.assertTrue(all(pin.type == "no_connect" for pin in self.board.parts[name].pins if pin.number not in wanted))

    def test_pads_of_each_footprint_are_the_pins_of_its_part(self):
        for part in self.board.parts.values():
            library, _, name = part.footprint.partition(":")
            path = FOOTPRINTS / f"{library}.pretty" / f"{name}.kicad_mod"
            self.assertTrue(path.exists(), f"{part.name}: found no {path}")
            pads = {pad[1] for pad in all_of(parse(path.read_text()), "pad") if pad[2] != "np_thru_hole"} - {""}
            self.assertEqual(pads, {pin.number for pin in part.pins}, part.name)


if __name__ == "__main__":
    if packages():
        sys.exit(f"found no {', '.join(packages())}; as root: apt-get install --no-install-recommends {' '.join(packages())} (tools/packages.sh: kicad_packages)")
    unittest.main()
