#!/usr/bin/env python3
"""Reads an Electronic Data Sheet and checks it against CiA 306-1, and its content against CiA 301.

Usage: eds_test.py FILE PROGRAM (proleg-objects)
"""

import configparser
import re
import subprocess
import sys
import unittest

VARIABLE, ARRAY, RECORD = 7, 8, 9
# CiA 301, table 44: bits, signed.
TYPES = {1: (1, False), 2: (8, True), 3: (16, True), 4: (32, True), 5: (8, False), 6: (16, False), 7: (32, False)}
# VISIBLE_STRING, OCTET_STRING, DOMAIN: they have no limits and are in no PDO.
LONG_TYPES = {9, 10, 15}
ACCESS = {"ro", "wo", "rw", "rwr", "rww", "const"}
LISTS = ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects")
# The keys of an object in CiA 306-1. Strict readers (Lely's dcfchk and dcfgen) refuse a file with others.
KEYS = {"ParameterName", "ObjectType", "SubNumber", "DataType", "LowLimit", "HighLimit", "AccessType", "DefaultValue",
        "PDOMapping", "ObjFlags", "CompactSubObj"}
# The keys that python-canopen reads beside them.
UNIT_KEYS = {"Factor", "Unit", "Description"}


def parse(text):
    eds = configparser.RawConfigParser(strict=True)  # a section or key that comes twice is an error
    eds.optionxform = str
    eds.read_string(text)
    return eds


class Check:
    def __init__(self, text, keys=frozenset(KEYS)):
        self.eds = parse(text)
        self.keys = keys
        self.text = text
        self.errors = []
        self.file_info()
        self.device_info()
        self.objects()
        self.pdos()

    def expect(self, condition, error):
        if not condition:
            self.errors.append(error)

    def get(self, section, key, pattern=None):
        value = self.eds.get(section, key, fallback=None)
        self.expect(value is not None, f"[{section}] has no {key}")
        if value is not None and pattern is not None:
            self.expect(re.fullmatch(pattern, value), f"[{section}] {key}={value}")
        return value if value is not None else ""

    def number(self, section, key, node=0):
        """Decimal or hexadecimal, with the node id added where the file says so."""
        text = self.get(section, key)
        match = re.fullmatch(r"(\$NODEID\+)?(0x[0-9A-F]+|0|-?[1-9][0-9]*)", text)
        self.expect(match, f"[{section}] {key}={text}, expected a number")
        return int(match[2], 0) + (node if match[1] else 0) if match else 0

    def file_info(self):
        self.get("FileInfo", "FileName", r"[\w.]+\.eds")
        for key in ("FileVersion", "FileRevision"):
            self.expect(0 <= self.number("FileInfo", key) <= 255, f"{key} has 8 bits")
        self.get("FileInfo", "EDSVersion", r"\d\.\d")
        self.expect(len(self.get("FileInfo", "Description")) <= 243, "Description is too long")
        for event in ("Creation", "Modification"):
            self.get("FileInfo", event + "Time", r"(0[1-9]|1[0-2]):[0-5]\d(AM|PM)")
            self.get("FileInfo", event + "Date", r"(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])-\d{4}")
        for key in ("CreatedBy", "ModifiedBy"):
            self.expect(len(self.get("FileInfo", key)) <= 245, f"{key} is too long")

    def device_info(self):
        for key in ("VendorName", "ProductName", "OrderCode"):
            self.get("DeviceInfo", key)
        for rate in (10, 20, 50, 125, 250, 500, 800, 1000):
            self.get("DeviceInfo", f"BaudRate_{rate}", "[01]")
        for key in ("SimpleBootUpMaster", "SimpleBootUpSlave", "DynamicChannelsSupported", "GroupMessaging",
                    "LSS_Supported"):
            self.get("DeviceInfo", key, "[01]")
        self.expect(0 <= self.number("DeviceInfo", "Granularity") <= 64, "Granularity is 0 to 64")
        for number in range(1, 8):
            self.get("DummyUsage", f"Dummy{number:04}", "[01]")
        for line in range(1, self.number("Comments", "Lines") + 1):
            self.get("Comments", f"Line{line}")
        for key, sub in (("VendorNumber", 1), ("RevisionNumber", 3)):
            self.expect(self.number("DeviceInfo", key) == self.number(f"1018sub{sub}", "DefaultValue"),
                        f"{key} differs from object 1018sub{sub}")

    def objects(self):
        self.entries = {}  # (index, sub) -> section
        self.subs = {}  # section of an index -> its sections of sub-indices
        for section in self.eds.sections():
            match = re.fullmatch("([0-9A-F]{4})sub[0-9A-F]+", section)
            if match:
                self.subs.setdefault(match[1], []).append(section)
        listed = []
        for name in LISTS:
            count = self.number(name, "SupportedObjects")
            self.expect(len(self.eds.options(name)) == count + 1, f"[{name}] does not list {count} objects")
            indices = [self.number(name, str(i)) for i in range(1, count + 1)]
            self.expect(indices == sorted(indices), f"[{name}] is not sorted")
            for index in indices:
                if name == "MandatoryObjects":
                    right = index in (0x1000, 0x1001, 0x1018)
                elif name == "ManufacturerObjects":
                    right = 0x2000 <= index <= 0x5FFF
                else:
                    right = 0x1000 <= index <= 0x1FFF or 0x6000 <= index <= 0xFFFF
                self.expect(right, f"{index:04X} is not one of the {name}")
                self.object(index)
            listed += indices
        self.expect(len(listed) == len(set(listed)), "an object is listed twice")
        known = {"FileInfo", "DeviceInfo", "DummyUsage", "Comments", *LISTS}
        expected = {f"{index:04X}" for index in listed}
        expected |= {section for section in self.entries.values()}
        self.expect(set(self.eds.sections()) - known == expected, "sections and lists of objects differ: "
                    + ", ".join(sorted((set(self.eds.sections()) - known) ^ expected)[:5]))

        for section in expected & set(self.eds.sections()):
            self.expect(set(self.eds[section]) <= self.keys, f"[{section}] has keys that CiA 306 does not have: "
                        + ", ".join(sorted(set(self.eds[section]) - self.keys)))

    def object(self, index):
        section = f"{index:04X}"
        if not self.eds.has_section(section):
            self.errors.append(f"[{section}] is missing")
            return
        code = self.number(section, "ObjectType")
        self.expect(code in (VARIABLE, ARRAY, RECORD), f"[{section}] ObjectType={code}")
        if code == VARIABLE:
            self.entry(section, index, 0)
            return
        self.name(section)
        self.expect("DataType" not in self.eds[section], f"[{section}] is not a variable and has a DataType")
        subs = self.subs.get(section, [])
        count = self.number(section, "SubNumber")
        self.expect(len(subs) == count and count >= 2, f"[{section}] SubNumber={count}, found {len(subs)}")
        numbers = sorted(int(s[7:], 16) for s in subs)
        for sub in subs:
            self.entry(sub, index, int(sub[7:], 16))
        if index == 0x1003:  # the number of errors; a write of 0 clears them (CiA 301, 7.5.2.4)
            self.expect(self.get("1003sub0", "AccessType") == "rw", "[1003sub0] cannot be cleared")
        elif numbers[:1] == [0]:
            self.expect(self.number(f"{section}sub0", "DefaultValue") == numbers[-1],
                        f"[{section}sub0] is not the highest sub-index")
            self.expect(self.number(f"{section}sub0", "DataType") == 5, f"[{section}sub0] is not an UNSIGNED8")
        else:
            self.errors.append(f"[{section}] has no sub-index 0")
        if code == ARRAY:
            types = {self.get(sub, "DataType") for sub in subs if not sub.endswith("sub0")}
            self.expect(len(types) == 1, f"[{section}] is an array of {types}")

    def name(self, section):
        name = self.get(section, "ParameterName")
        self.expect(0 < len(name) <= 241 and name.isascii(), f"[{section}] ParameterName={name}")

    def entry(self, section, index, sub):
        self.entries[index, sub] = section
        self.name(section)
        self.expect(self.number(section, "ObjectType") == VARIABLE, f"[{section}] is not a variable")
        self.get(section, "PDOMapping", "[01]")
        access = self.get(section, "AccessType")
        self.expect(access in ACCESS, f"[{section}] AccessType={access}")
        kind = self.number(section, "DataType")
        if kind in LONG_TYPES:
            self.expect(self.get(section, "PDOMapping") == "0", f"[{section}] cannot be mapped")
            self.expect(not {"LowLimit", "HighLimit"} & set(self.eds[section]), f"[{section}] has limits")
            self.expect(access != "const" or "DefaultValue" in self.eds[section], f"[{section}] has no DefaultValue")
            return
        if kind not in TYPES:
            self.errors.append(f"[{section}] DataType={kind}")
            return
        bits, signed = TYPES[kind]
        low, high = (-2 ** (bits - 1), 2 ** (bits - 1) - 1) if signed else (0, 2 ** bits - 1)
        if "LowLimit" in self.eds[section]:
            limit = self.number(section, "LowLimit")
            self.expect(low <= limit, f"[{section}] LowLimit={limit} is outside the type")
            low = limit
        if "HighLimit" in self.eds[section]:
            limit = self.number(section, "HighLimit")
            self.expect(limit <= high, f"[{section}] HighLimit={limit} is outside the type")
            high = limit
        self.expect(low <= high, f"[{section}] has limits {low} to {high}")
        if "DefaultValue" in self.eds[section]:
            for node in (1, 127):
                value = self.number(section, "DefaultValue", node)
                self.expect(low <= value <= high, f"[{section}] DefaultValue={value} is outside {low} to {high}")
        self.expect(access not in ("const", "rw", "rww") or access == "rww" or "DefaultValue" in self.eds[section],
                    f"[{section}] has no DefaultValue")

    def pdos(self):
        """Each PDO has both parameters (CiA 301, 7.5.2.35 to 38); what it maps exists and may be mapped."""
        mapped = set()
        for key, first, accesses in (("NrOfRXPDO", 0x1400, {"rw", "rww", "wo"}),
                                     ("NrOfTXPDO", 0x1800, {"ro", "rw", "rwr", "const"})):
            pdos = [index for index, sub in self.entries if sub == 0 and first <= index < first + 0x200]
            maps = [index for index, sub in self.entries if sub == 0 and first + 0x200 <= index < first + 0x400]
            self.expect(sorted(maps) == sorted(index + 0x200 for index in pdos), f"{key}: mappings without PDO")
            self.expect(self.number("DeviceInfo", key) == len(pdos), f"{key} is not {len(pdos)}")
            for index in pdos:
                self.expect((index, 1) in self.entries and (index, 2) in self.entries, f"{index:04X} is not complete")
                for sub in (sub for of, sub in self.entries if of == index):
                    self.expect("DefaultValue" in self.eds[self.entries[index, sub]],
                                f"[{index:04X}sub{sub}] has no DefaultValue: a master cannot set up its side of the PDO")
            for index in maps:
                bits = 0
                for sub in range(1, self.number(f"{index:04X}sub0", "DefaultValue") + 1):
                    entry = self.number(f"{index:04X}sub{sub}", "DefaultValue")
                    target = self.entries.get((entry >> 16, entry >> 8 & 0xFF))
                    if target is None:
                        self.errors.append(f"[{index:04X}sub{sub}] maps {entry:08X}, which does not exist")
                        continue
                    mapped.add(target)
                    bits += entry & 0xFF
                    self.expect(TYPES[self.number(target, "DataType")][0] == entry & 0xFF,
                                f"[{index:04X}sub{sub}] maps {entry & 0xFF} bits of [{target}]")
                    self.expect(self.get(target, "PDOMapping") == "1", f"[{target}] is mapped and not mappable")
                    self.expect(self.get(target, "AccessType") in accesses,
                                f"[{target}] is {self.get(target, 'AccessType')} and mapped in [{index:04X}]")
                self.expect(0 < bits <= 64, f"[{index:04X}] maps {bits} bits")
        for section in self.entries.values():
            self.expect(self.get(section, "PDOMapping") == "0" or section in mapped,
                        f"[{section}] is mappable and in no PDO, though mappings are fixed")


class EdsTest(unittest.TestCase):
    text = ""
    text_with_units = ""

    def test_the_file_is_as_the_standard_wants_it(self):
        self.assertEqual(Check(self.text).errors, [])

    def test_it_describes_a_module(self):
        check = Check(self.text)
        self.assertEqual(check.number("1000", "DefaultValue"), 0x00020192, "servo drive, CiA 402")
        self.assertEqual(check.number("1008", "DataType"), 9, "VISIBLE_STRING")
        self.assertEqual(check.get("1008", "DefaultValue"), "Proleg joint module")
        self.assertEqual([check.get(index, "AccessType") for index in ("1008", "1009", "100A")], ["const", "ro", "ro"])
        self.assertEqual(check.number("1200sub1", "DefaultValue", 3), 0x603)
        self.assertEqual(check.number("1200sub2", "DefaultValue", 3), 0x583)
        self.assertEqual(check.number("1014", "DefaultValue", 3), 0x083)
        self.assertEqual(check.number("1800sub1", "DefaultValue", 3) & 0x7FF, 0x183)
        self.assertEqual(check.number("DeviceInfo", "NrOfRXPDO"), 1 + 2 * 64)
        self.assertEqual(check.number("DeviceInfo", "NrOfTXPDO"), 3)
        self.assertEqual(check.number("4080sub1", "HighLimit"), 2 ** 30, "amplitude: 90 degrees")
        self.assertIn("amplitude", check.get("4080", "ParameterName"))

    def test_a_line_has_one_equals_sign(self):
        """Simple readers split a line at each of them."""
        for text in (self.text, self.text_with_units):
            self.assertEqual([line for line in text.splitlines() if line.count("=") > 1], [])

    def test_units_are_the_only_difference_between_the_two_files(self):
        def plain(text):
            in_objects = text[text.index("[MandatoryObjects]"):]
            return [line for line in in_objects.splitlines() if line.split("=")[0] not in UNIT_KEYS]

        self.assertEqual(plain(self.text_with_units), plain(self.text))

    def test_values_have_the_factor_and_unit_that_python_canopen_reads(self):
        check = Check(self.text_with_units, KEYS | UNIT_KEYS)
        self.assertEqual(check.errors, [])
        units = set()
        for section in check.eds.sections():
            if check.eds.has_option(section, "Factor"):
                units.add(check.eds.get(section, "Unit", fallback=""))  # a ratio has none
                self.assertGreater(float(check.get(section, "Factor")), 0)
        self.assertEqual(units, {"deg", "Hz", "1/s", ""})
        # From docs/protocol.md: 90 degrees are 2^30, 1 Hz is 2^24.
        self.assertEqual(float(check.get("3080sub1", "Factor")) * check.number("3080sub1", "HighLimit"), 90)
        # From docs/protocol.md: RPDO1 with 45 degrees, the monitoring with 44.9 degrees, 350 mA and 31 degrees Celsius.
        for section, number, value, unit in (("607A", 0x20000000, 45, "deg"), ("2009sub1", 0x1FEE, 44.9, "deg"),
                                             ("6078", 350, 350, "mA"), ("2009sub2", 31, 31, "degC"),
                                             ("200Asub2", 500, 500, "ms"), ("6080", 720, 720, "deg/s")):
            factor = float(check.eds.get(section, "Factor", fallback="1"))
            self.assertAlmostEqual(factor * number, value, delta=0.01, msg=section)
            self.assertEqual(check.get(section, "Unit"), unit, section)
        frequencies = [s for s in check.eds.sections() if check.eds.get(s, "Unit", fallback="") == "Hz"]
        self.assertEqual({float(check.get(s, "Factor")) for s in frequencies}, {2.0 ** -24})

    def test_names_are_keys_for_python_canopen_and_say_what_an_entry_is(self):
        """A name finds an index in the dictionary, and an entry in its index; a list of entries shows theirs alone."""
        check = Check(self.text_with_units, KEYS | UNIT_KEYS)
        names = {}
        for (index, sub), section in check.entries.items():
            variable = check.eds.has_section(f"{index:04X}") and section == f"{index:04X}"
            parent = "" if variable else check.get(f"{index:04X}", "ParameterName")
            self.assertNotIn(".", parent + check.get(section, "ParameterName"), "the mark between the two names")
            names.setdefault((parent, check.get(section, "ParameterName")), []).append(section)
        self.assertEqual([entries for entries in names.values() if len(entries) > 1], [])
        tops = [check.get(section, "ParameterName") for section in check.eds.sections() if len(section) == 4]
        self.assertEqual(len(tops), len(set(tops)))
        self.assertEqual(check.get("3080sub1", "ParameterName"), "amplitude of slot 1")
        self.assertEqual(check.get("4081sub2", "ParameterName"), "frequency, staged, of slot 2")
        self.assertEqual(check.get("3080sub1", "Description"), "How far the joint swings to each side.")
        for section in check.entries.values():
            if section[0] in "345" and not section.endswith("sub0"):
                self.assertIn(check.get(section[:4], "ParameterName").split()[1].rstrip(","),
                              check.get(section, "ParameterName"))
                self.assertTrue(check.get(section, "Description"))

    def test_the_check_finds_what_is_wrong(self):
        for pattern, replacement in (
                (r"BaudRate_1000=1\n", ""),
                (r"CreationDate=.*", "CreationDate=2026-11-20"),
                (r"RevisionNumber=.*", "RevisionNumber=2"),
                (r"NrOfRXPDO=129", "NrOfRXPDO=128"),
                (r"(\[1018\]\n.*\n.*\n)SubNumber=5", r"\1SubNumber=4"),
                (r"(\[1018sub0\]\n(?:.*\n){4})DefaultValue=0x04", r"\1DefaultValue=0x03"),
                (r"3=0x1018\n", "3=0x1019\n"),
                (r"\[ManufacturerObjects\]\nSupportedObjects=\d+", "[ManufacturerObjects]\nSupportedObjects=7"),
                (r"\[2005sub4\]", "[2005sub9]"),
                (r"\[6041\]", "[6042]"),
                (r"HighLimit=0x40\n", "HighLimit=0x140\n"),
                (r"LowLimit=-1073741824\n", "LowLimit=1073741825\n"),
                (r"DefaultValue=-1\n", "DefaultValue=-129\n"),
                (r"DataType=0x0002", "DataType=0x0010"),
                (r"DefaultValue=Proleg joint module\n", ""),
                (r"(\[1009\]\n(?:.*\n){4})PDOMapping=0", r"\1PDOMapping=1"),
                (r"AccessType=rww", "AccessType=ro"),
                (r"(\[2010sub1\]\n(?:.*\n){4})PDOMapping=1", r"\1PDOMapping=0"),
                (r"(\[2000sub3\]\n(?:.*\n){4})PDOMapping=0", r"\1PDOMapping=1"),
                (r"DefaultValue=0x60400010", "DefaultValue=0x60400008"),
                (r"DefaultValue=0x60400010", "DefaultValue=0x60500010"),
                (r"(\[1802sub2\]\n(?:.*\n)*?)DefaultValue=0x0A\n", r"\1"),
                (r"(\[607A\]\n)", r"\1Unit=deg\n"),
        ):
            with self.subTest(pattern=pattern):
                wrong, count = re.subn(pattern, replacement, self.text, count=1)
                self.assertEqual(count, 1)
                self.assertNotEqual(Check(wrong).errors, [])


if __name__ == "__main__":
    with open(sys.argv.pop(1), encoding="ascii") as file:
        EdsTest.text = file.read()
    EdsTest.text_with_units = subprocess.run([sys.argv.pop(1), "--eds", "--units"], stdout=subprocess.PIPE, check=True,
                                             text=True).stdout
    unittest.main()
