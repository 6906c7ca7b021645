"""The constants of registers in firmware and virtual chip against facts from outside.

Arguments: the folder of the sources, the program chip_registers, the compiler and objcopy. facts.tsv says what the
facts are, without_facts.tsv which constants have none, planted_errors.tsv which errors the comparison must find."""

import collections
import concurrent.futures
import fnmatch
import functools
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
from constants import Compiler, constants_of  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
CHIP_REGISTERS, COMPILER, OBJCOPY = (sys.argv.pop(1) for _ in range(3))

# Sources whose constants are checked: each needs a fact, or a reason in without_facts.tsv.
COMPLETE = ["firmware/stm32f405/registers/*.hpp", "firmware/stm32f405/pins.hpp", "firmware/stm32f405/factory_data.hpp",
            "firmware/stm32f405/flash_layout.hpp", "sim/mcu/chip/*.?pp", "sim/mcu/cpu/*.?pp",
            "sim/mcu/peripherals/*.?pp"]
MODELS = "models"  # the output of chip_registers
LABELS = {"ST", "ARM", "SVD", "modm", "opencm3", "RM0090", "PM0214", "DS8626", "DDI"}

Fact = collections.namedtuple("Fact", "unit name value sources settled")


def rows(name):
    """Rows of a table below its comments and its head, with \\n and \\t in them as such."""
    lines = [line for line in (HERE / name).read_text().splitlines() if not line.startswith("#")]
    width = lines[0].count("\t") + 1
    for line in lines[1:]:
        cells = [cell.replace("\\n", "\n").replace("\\t", "\t") for cell in line.split("\t")]
        assert len(cells) == width, f"{name}: found {len(cells)} columns, expected {width}: {line}"
        yield cells


FACTS = [Fact(unit, name, int(value, 0), tuple(sources.split("; ")), settled)
         for unit, name, value, sources, settled in rows("facts.tsv")]


class Source:
    """The sources, or a copy in which some are changed."""

    def __init__(self, folder, overlay=None, models=None):
        self.compiler = Compiler(COMPILER, OBJCOPY, SOURCES, folder)
        self.overlay = overlay
        self.models = models if models is not None else printed_models()

    def text(self, unit):
        changed = self.overlay and self.overlay / unit
        return (changed if changed and changed.exists() else SOURCES / unit).read_text()

    def units(self):
        return sorted({str(path.relative_to(SOURCES)) for pattern in COMPLETE for path in SOURCES.glob(pattern)})

    def values(self, facts):
        """The value that each fact is about."""
        jobs = collections.defaultdict(list)
        values = {}
        for fact in facts:
            if fact.unit == MODELS:
                values[fact] = self.models.get(fact.name)
            elif "@" in fact.name:
                values[fact] = number_in_text(self.text(fact.unit), fact.name)
            elif fact.unit.endswith(".ld"):
                values[fact] = number_of_linker(self.text(fact.unit), fact.name)
            else:
                jobs[group(fact.unit)].append(fact)

        def compile_group(name):
            facts_of_group = jobs[name]
            files = sorted({fact.unit for fact in facts_of_group})
            namespace = "proleg::stm32f405" if files[0].startswith("firmware") else "proleg::sim"
            return zip(facts_of_group, self.compiler.values(re.sub(r"\W", "_", name), files, namespace,
                                                            [fact.name for fact in facts_of_group], self.overlay))

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for found in pool.map(compile_group, jobs):
                values.update(found)
        return values

    def differences(self, units=None):
        """Facts that have another value here, and the values."""
        values = self.values([fact for fact in FACTS if units is None or fact.unit in units])
        return [(fact, value) for fact, value in values.items() if value != fact.value]

    def without_fact(self, units=None):
        """Constants that have neither fact nor reason, and the reasons that are in use."""
        reasons = list(rows("without_facts.tsv"))
        missing, used = [], set()
        names = [(unit, constant.text) for unit in self.units() if units is None or unit in units
                 for constant in constants_of(self.text(unit)) if not has_fact(unit, constant)]
        if units is None or MODELS in units:
            with_facts = {fact.name for fact in FACTS if fact.unit == MODELS}
            names += [(MODELS, name) for name in self.models if name not in with_facts]
        for unit, name in names:
            matching = [index for index, (in_unit, pattern, _) in enumerate(reasons)
                        if fnmatch.fnmatchcase(unit, in_unit) and fnmatch.fnmatchcase(name, pattern)]
            used.update(matching)
            if not matching:
                missing.append((unit, name))
        return missing, len(names) - len(missing), [row for index, row in enumerate(reasons) if index not in used]


def group(unit):
    """Sources that are compiled together: all headers of a side, and each other source by itself."""
    return unit.split("/")[0] + ".hpp" if unit.endswith(".hpp") else unit


@functools.lru_cache(None)
def expressions_of(unit):
    return "\n".join(fact.name for fact in FACTS if fact.unit == unit)


def has_fact(unit, constant):
    """Whether an expression of a fact names a constant."""
    name = constant.name
    if constant.is_local:
        pattern = rf"\blocal::{constant.scope}::{name}\b"
    elif constant.scope[:1].isupper():  # a class: Timer::cr1_cen, tim2.cr1()
        pattern = rf"\b{constant.scope}::{name}\b|\b{constant.scope}\(.*\)\.{name}\b|^\w+\.{name}\b"
    elif constant.scope:
        pattern = rf"\b{constant.scope}::{name}\b"
    else:
        pattern = rf"(?<![\w:.]){name}\b"
    return re.search(pattern, expressions_of(unit), re.M) is not None


@functools.lru_cache(None)
def printed_models():
    return models_in(subprocess.run([CHIP_REGISTERS], check=True, capture_output=True, text=True).stdout)


def models_in(text):
    lines = (line.split("\t") for line in text.splitlines())
    return {name: None if value == "rejected" else int(value, 0) for name, value in lines}


def number_in_text(text, pattern):
    """The number at @, if it is the same in each place."""
    found = set(re.findall(re.escape(pattern).replace("@", r"(0x[0-9A-Fa-f']+|\d[\d']*)", 1), text))
    return int(found.pop().replace("'", ""), 0) if len(found) == 1 else None


def number_of_linker(text, expression):
    """Value of ORIGIN and LENGTH of a linker script, or a sum of them."""
    regions = {}
    region = r"^ *(\w+) *\([rwx]+\) *: *ORIGIN = ([^,\n]+), LENGTH = ([^\n]+)$"
    for name, origin, length in re.findall(region, text, re.M):
        regions[f"ORIGIN({name})"], regions[f"LENGTH({name})"] = sum_of(origin), sum_of(length)
    terms = expression.split(" + ")
    return sum(regions[term] for term in terms) if all(term in regions for term in terms) else None


def sum_of(text):
    terms = re.findall(r"([+-]?) *(0x[0-9A-Fa-f]+|\d+)(K?)", text)
    return sum(int(number, 0) * (1024 if unit else 1) * (-1 if sign == "-" else 1) for sign, number, unit in terms)


def hexadecimal(value):
    return "none" if value is None else hex(value)


class Registers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_each_constant_has_the_value_of_its_fact(self):
        differences = Source(self.folder).differences()
        comparisons = sum(len(fact.sources) for fact in FACTS)
        by_unit = collections.Counter(fact.unit.split("/")[0] for fact in FACTS)
        print(f"{len(FACTS)} facts, {comparisons} comparisons, {len(differences)} differences; "
              + ", ".join(f"{unit} {count}" for unit, count in sorted(by_unit.items())))
        self.assertEqual([f"{fact.unit}: {fact.name}: found {hexadecimal(value)}, expected {hex(fact.value)}: "
                          + "; ".join(fact.sources) for fact, value in differences], [])

    def test_each_constant_has_a_fact_or_a_reason_why_it_has_none(self):
        missing, exempt, unused = Source(self.folder).without_fact()
        print(f"{exempt} constants without a fact have a reason")
        self.assertEqual(missing, [], "add a fact to facts.tsv, or a reason to without_facts.tsv")
        self.assertEqual(unused, [], "no constant needs this reason")

    def test_each_fact_is_listed_once_and_names_its_sources(self):
        places = collections.Counter((fact.unit, fact.name) for fact in FACTS)
        self.assertEqual([place for place, count in places.items() if count != 1], [])
        for fact in FACTS:
            for source in fact.sources:
                self.assertIn(source.split(" ")[0], LABELS, fact)

    def test_where_a_source_is_wrong_the_manual_decides(self):
        settled = [fact for fact in FACTS if fact.settled]
        print(f"{len(settled)} facts in which a source differs from the manual")
        for fact in settled:
            self.assertRegex(fact.sources[0], r"^RM0090 \d+\.\d+", fact)

    def test_planted_errors_are_found(self):
        planted = list(rows("planted_errors.tsv"))
        self.assertGreaterEqual(len(planted), 10)
        output = subprocess.run([CHIP_REGISTERS], check=True, capture_output=True, text=True).stdout

        def reported(number, unit, right, wrong):
            folder = self.folder / str(number)
            overlay = folder / "changed"
            (overlay / unit).parent.mkdir(parents=True)
            text = output if unit == MODELS else (SOURCES / unit).read_text()
            self.assertEqual(text.count(right), 1, (unit, right))
            changed = text.replace(right, wrong)
            if unit != MODELS:
                (overlay / unit).write_text(changed)
            source = Source(folder, overlay, models_in(changed) if unit == MODELS else None)
            reports = [fact.name for fact, _ in source.differences({unit})]
            reports += [f"no fact {name}" for _, name in source.without_fact({unit})[0]]
            return reports

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            found = list(pool.map(lambda numbered: reported(numbered[0], *numbered[1][1:4]), enumerate(planted)))
        for (what, unit, _, _, name), reports in zip(planted, found):
            print(f"planted: {what}: " + (f"found {name!r}" if name in reports else "NOT FOUND"))
            self.assertIn(name, reports, (what, unit))
            self.assertLess(len(reports), 30, "one error, many reports")


if __name__ == "__main__":
    unittest.main(verbosity=2)
