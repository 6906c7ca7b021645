#!/usr/bin/env python3
"""'proleg flash --bare' with the real openocd, dfu-util and stm32flash, and a chip that is a program.

The chip is reached as a real one is: over JTAG (fake_jtag.py), USB (fake_libusb.cpp) and a UART (fake_rom.py). A command or an
option that a tool does not know, or that does something else than expected, is seen in the flash of the chip. No test can
reach a real chip: each tool gets another interface than the one that a computer has.

Usage: flash_bare_test.py SOURCE_FOLDER PROGRAM_FOLDER LIBUSB
"""

import contextlib
import hashlib
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.dont_write_bytecode = True
from fake_jtag import JtagChip  # noqa: E402
from fake_rom import DfuRom, UartRom  # noqa: E402
from fake_stm32 import FACTORY_OPTIONS, FLASH, SECTORS, Stm32F405  # noqa: E402

LONGEST = 300  # seconds that a command may take on a busy computer
SLOT_A, SETTINGS = 0x08020000, 0x08008000
PLACE = 32 * 1024  # of the bootloader: sectors 0 and 1
ERASED = 0xFF
KEPT = 0x5A
PROBES = ("stlink", "dfu", "uart")  # one of each tool
SWD_PROBES = ("stlink", "jlink", "cmsis-dap")
# Brown-out level 3 (bits 3:2 are 0) and sectors 0 and 1 protected (bits 16 and 17 are 0); all else as delivered: RM0090, section 3.9.10.
RIGHT_OPTIONS = FACTORY_OPTIONS & ~3 & ~0x3000C
NO_PROBE = "adapter driver hla\nhla_layout stlink\nhla_device_desc none\nhla_vid_pid 0x0000 0x0000\n"
# dfu-util ends when it finds one; stm32flash goes on without it.
WRONG_OPTION = re.compile("(invalid|unrecognized) option")


def program(address, size, seed):
    """Bytes that begin with a vector table."""
    vectors = struct.pack("<4I", 0x20000800, address + 0x11, address + 0x21, address + 0x31)
    return (vectors + random.Random(seed).randbytes(size))[:size]


def image(size=200, board=1, address=SLOT_A + 512):
    """As docs/flashing.md describes it."""
    body = program(address, size, seed=1)
    header = struct.pack("<4s3H2B4HI2BHIII20sI32s64s", b"PIMG", 1, 512, board, 0, 255, 1, 2, 3, 0x0100, 0, 2, 0, 0, address,
                         len(body), zlib.crc32(body), bytes(20), 0, hashlib.sha256(body).digest(), bytes(64))
    header = header.ljust(508, b"\0")
    return header + struct.pack("<I", zlib.crc32(header)) + body


def bootloader_of_board(board):
    """With the board in the vector table, as shared/image/board_names.hpp says."""
    content = program(FLASH, 300, seed=6)
    return content[:28] + struct.pack("<HH", board, 0x5042) + content[32:]


def elf(parts):
    """(physical address, content): a file with a program header for each."""
    offset = 52 + 32 * len(parts)
    head = struct.pack("<4s3B9x2H5I6H", b"\x7fELF", 1, 1, 1, 2, 40, 1, FLASH, 52, 0, 0, 52, 32, len(parts), 40, 0, 0)
    table, contents = b"", b""
    for address, content in parts:
        table += struct.pack("<8I", 1, offset + len(contents), 0x20000000, address, len(content), len(content), 5, 4)
        contents += content
    return head + table + contents


# Small, since each bit of them passes through JTAG; larger than one block of 256 bytes of stm32flash.
BOOTLOADER = program(FLASH, 300, seed=2)
OTHER_BOOTLOADER = program(FLASH, 360, seed=3)
LARGE_BOOTLOADER = program(FLASH, 17_000, seed=5)  # more than a sector
IMAGE = image()


class FlashBare(unittest.TestCase):
    source = programs = libusb = None

    def setUp(self):
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        for name in ("scripts/interface", "bin", "temporary"):
            (self.folder / name).mkdir(parents=True)
        # A pseudo terminal has no parity. All else is as for a serial line.
        wrapper = self.folder / "bin" / "stm32flash"
        wrapper.write_text(f'#!/bin/sh\nexec {shutil.which("stm32flash")} -m 8n1 "$@"\n')
        wrapper.chmod(0o755)
        # The chip has JTAG only. A command for SWD reaches it without its selection, which openocd itself reads in
        # test_a_missing_probe_is_named.
        wrapper = self.folder / "bin" / "openocd"
        wrapper.write_text("#!/bin/bash\nwords=()\nfor word; do\n  if [[ $PROLEG_JTAG && $word == 'transport select swd' ]]; then"
                           "\n    word='transport select jtag'\n  fi\n  words+=(\"$word\")\ndone\n"
                           f'exec {shutil.which("openocd")} "${{words[@]}}"\n')
        wrapper.chmod(0o755)
        self.set_interface(NO_PROBE)
        self.environment = {"PATH": f'{self.folder / "bin"}:{os.environ["PATH"]}', "HOME": str(self.folder),
                            "TMPDIR": str(self.folder / "temporary"), "LD_PRELOAD": str(self.libusb),
                            "OPENOCD_SCRIPTS": str(self.folder / "scripts")}
        self.write("boot.bin", BOOTLOADER)
        self.write("module.pimg", IMAGE)
        self.chip = Stm32F405()

    def set_interface(self, script):
        """What openocd reads as interface/stlink.cfg, jlink.cfg and cmsis-dap.cfg."""
        for name in SWD_PROBES:
            (self.folder / f"scripts/interface/{name}.cfg").write_text(script)

    def write(self, name, content):
        (self.folder / name).write_bytes(content)
        return name

    def run_flash(self, *words, **environment):
        return subprocess.run([self.programs / "proleg", "flash", *words], cwd=self.folder, capture_output=True, text=True,
                              errors="replace", timeout=LONGEST, env={**self.environment, **environment})

    @contextlib.contextmanager
    def connected(self, probe):
        """Arguments and environment for a tool that reaches the chip."""
        words = ["--bare", "--probe", probe]
        if probe in SWD_PROBES:
            with JtagChip(self.chip, self.folder) as cable:
                self.set_interface(cable.script)
                self.core = cable.core
                yield words, {"PROLEG_JTAG": "1"}
            self.set_interface(NO_PROBE)
        elif probe == "dfu":
            with DfuRom(self.chip, self.folder) as self.dfu:
                yield words, {"PROLEG_FAKE_DFU": str(self.dfu.path)}
        else:
            with UartRom(self.chip) as self.uart:
                yield [*words, "--port", self.uart.port], {"PROLEG_PATIENT_LINE": "1"}

    def flash(self, probe, *options, bootloader="boot.bin"):
        with self.connected(probe) as (words, environment):
            return self.run_flash(*words, "--bootloader", bootloader, *options, "module.pimg", **environment)

    def expect_flashed(self, result):
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertNotRegex(result.stderr, WRONG_OPTION)

    def expect_failed(self, result, message, status=1):
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        last_line = result.stderr.splitlines()[-1]
        self.assertTrue(last_line.startswith("proleg flash: "), result.stderr)
        self.assertIn(message, last_line)

    def expect_sector(self, number, content, rest=ERASED):
        self.assertEqual(self.chip.sector(number), content + bytes([rest]) * (SECTORS[number] - len(content)))

    def expect_complete(self, probe, bootloader=BOOTLOADER):
        erased = SECTORS[0] if len(bootloader) <= SECTORS[0] else PLACE
        self.assertEqual(self.chip.read(FLASH, erased), bootloader + bytes([ERASED]) * (erased - len(bootloader)))
        self.expect_sector(5, IMAGE)
        self.assertEqual(self.chip.options, RIGHT_OPTIONS if probe in SWD_PROBES else FACTORY_OPTIONS & ~3)

    @staticmethod
    def place_of_bootloader(probe):
        """The sectors that are erased for a bootloader that fits into one: dfu-util erases what it writes."""
        return [0] if probe == "dfu" else [0, 1]

    def option_values(self):
        return self.chip.sectors("options")

    # --- requirements

    def test_an_empty_chip_gets_bootloader_and_image_and_nothing_else(self):
        for probe in dict.fromkeys(SWD_PROBES + PROBES):
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                self.expect_flashed(self.flash(probe))
                self.expect_complete(probe)
                for sector in (2, 3, 4, 6, 7, 8, 9, 10, 11):
                    self.expect_sector(sector, b"")
                self.assertEqual(list((self.folder / "temporary").iterdir()), [])

    def test_only_the_sectors_that_are_written_are_erased(self):
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                for sector in range(len(SECTORS)):
                    self.chip.fill(sector, KEPT)
                self.expect_flashed(self.flash(probe))
                self.expect_complete(probe)
                self.assertEqual(self.chip.sectors("erase"), [5, *self.place_of_bootloader(probe)])
                self.assertNotIn(("mass erase",), self.chip.events)
                for sector in (2, 3, 4, 6, 7, 8, 9, 10, 11):
                    self.expect_sector(sector, b"", rest=KEPT)

    def test_a_bootloader_may_be_larger_than_a_sector(self):
        self.write("large_boot.bin", LARGE_BOOTLOADER)
        self.expect_flashed(self.flash("dfu", bootloader="large_boot.bin"))
        self.expect_complete("dfu", bootloader=LARGE_BOOTLOADER)
        self.assertEqual(self.chip.sectors("erase"), [5, 0, 1])

    def test_with_a_node_id_the_settings_are_those_of_a_new_board(self):
        record = self.folder / "record.bin"
        subprocess.run([sys.executable, self.source / "firmware/stm32f405/make_board_record.py", "--node", "3", record],
                       check=True)
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                self.chip.fill(2, KEPT)
                self.chip.fill(3, KEPT)
                self.expect_flashed(self.flash(probe, "--node", "3"))
                self.expect_complete(probe)
                self.assertEqual(self.chip.read(SETTINGS, 2 * SECTORS[2]), record.read_bytes())
                self.assertEqual(self.chip.sectors("erase"), [2, 3, 5, *self.place_of_bootloader(probe)])

    def test_with_a_public_key_the_chip_takes_only_images_that_are_signed_with_it(self):
        self.run_tool("image", "key", "update.pem")
        self.write("unsigned.pimg", (self.folder / "module.pimg").read_bytes())
        self.run_tool("image", "sign", "module.pimg", "--key", "update.pem", "--output", "module.pimg")
        signed = (self.folder / "module.pimg").read_bytes()
        public = subprocess.run(["openssl", "pkey", "-pubin", "-in", "update.pub.pem", "-outform", "DER"], check=True,
                                cwd=self.folder, capture_output=True).stdout[-32:]
        # firmware/bootloader/trust_store.hpp
        record = b"PKEY" + public + bytes(24)
        record += struct.pack("<I", zlib.crc32(record))
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                self.chip.fill(4, KEPT)
                self.expect_flashed(self.flash(probe, "--public-key", "update.pub.pem"))
                self.expect_sector(4, record)
                self.expect_sector(5, signed)
                self.assertEqual(self.chip.sectors("erase"), [4, 5, *self.place_of_bootloader(probe)])
        (self.folder / "unsigned.pimg").replace(self.folder / "module.pimg")
        self.chip = Stm32F405()
        result = self.flash("stlink", "--public-key", "update.pub.pem")
        self.expect_failed(result, "module.pimg: found an image that the module would not start (it is not signed", status=2)
        self.assertEqual(self.chip.events, [])

    def run_tool(self, *words):
        subprocess.run([self.programs / "proleg", *words], cwd=self.folder, check=True, capture_output=True,
                       timeout=LONGEST)

    def test_the_image_is_there_before_the_bootloader_and_the_option_bytes_come_last(self):
        self.expect_flashed(self.flash("stlink"))
        self.assertEqual([event[:2] if event[0] != "options" else event[0] for event in self.chip.events],
                         [("erase", 5), ("program", 5), ("erase", 0), ("erase", 1), ("program", 0), "options", "options"])
        self.assertEqual(self.core.runs, 1)
        self.assertFalse(self.core.is_halted)

    def test_no_option_byte_but_brown_out_level_and_protection_of_the_bootloader_ever_changes(self):
        for options in (FACTORY_OPTIONS, 0x0FFFAA0D, 0x0FF0AA4D, 0x0FFFAAE1):
            with self.subTest(options=hex(options)):
                self.chip = Stm32F405()
                self.chip.options = options & ~3
                self.expect_flashed(self.flash("stlink"))
                for value in self.option_values():
                    self.assertEqual((value ^ options) & ~3 & ~0x3000C, 0, hex(value))
                self.assertEqual(self.chip.options, options & ~3 & ~0x3000C)

    def test_only_a_probe_at_swd_sets_option_bytes_and_the_others_say_so(self):
        for probe in ("dfu", "uart"):
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                result = self.flash(probe)
                self.expect_flashed(result)
                self.assertEqual(self.option_values(), [])
                self.assertRegex(result.stdout, r"options  not set: .*--probe stlink, jlink or cmsis-dap\) sets them")
                self.assertIn("set BOOT0 to low", result.stdout)
        self.assertEqual(self.dfu.alternates.count(0), len(self.dfu.alternates))
        self.assertEqual(set(self.uart.commands) - {0x00, 0x01, 0x02, 0x11, 0x31, 0x44}, set())
        # As these runs say.
        self.expect_flashed(self.flash("stlink"))
        self.expect_complete("stlink")

    def test_the_line_of_the_documents_sets_the_brown_out_level_and_nothing_else(self):
        text = (self.source / "docs/board.md").read_text()
        line = re.search(r"^    (openocd .*\\\n +-c .*options_write.*)$", text, re.MULTILINE)[1]
        for options in (FACTORY_OPTIONS, 0x0FFEAA4D):
            with self.subTest(options=hex(options)):
                self.chip = Stm32F405()
                self.chip.options = options & ~3
                with self.connected("stlink"):
                    result = subprocess.run(["sh", "-c", line], cwd=self.folder, env=self.environment, capture_output=True,
                                            timeout=LONGEST, text=True)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(self.chip.options, options & ~3 & ~0x0C)

    def test_the_second_time_bootloader_and_option_bytes_are_not_written_again(self):
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                self.expect_flashed(self.flash("stlink"))
                self.chip.events = []
                self.expect_flashed(self.flash(probe))
                self.assertEqual(self.chip.events, [("erase", 5), ("program", 5)])
                self.expect_complete("stlink")

    def test_another_bootloader_replaces_one_that_is_protected(self):
        self.expect_flashed(self.flash("stlink"))
        self.write("other.bin", OTHER_BOOTLOADER)
        self.chip.events = []
        self.expect_flashed(self.flash("stlink", bootloader="other.bin"))
        self.expect_complete("stlink", bootloader=OTHER_BOOTLOADER)
        self.assertEqual(self.option_values(), [RIGHT_OPTIONS | 0x30000, RIGHT_OPTIONS])

    def test_a_protected_bootloader_stays_if_no_st_link_is_there(self):
        self.expect_flashed(self.flash("stlink"))
        self.write("other.bin", OTHER_BOOTLOADER)
        for probe in ("dfu", "uart"):
            with self.subTest(probe=probe):
                self.expect_failed(self.flash(probe, bootloader="other.bin"), "--probe stlink")
                self.expect_complete("stlink")

    def test_a_run_that_is_interrupted_anywhere_can_be_repeated(self):
        # stm32flash waits half a minute for a chip that answers no more: its cuts are among the slow tests.
        has_all_cuts = "PROLEG_CUTS" in os.environ
        for probe in PROBES if has_all_cuts else ("stlink", "dfu"):
            self.chip = Stm32F405()
            self.expect_flashed(self.flash(probe, "--node", "3"))
            flashed, events = bytes(self.chip.flash), len(self.chip.events)
            self.assertGreaterEqual(events, 8 if probe == "stlink" else 6)
            for cut in range(events) if has_all_cuts else (events // 2,):
                with self.subTest(probe=probe, cut=cut):
                    self.chip = Stm32F405()
                    self.chip.fails_at = cut
                    self.assertEqual(self.flash(probe, "--node", "3").returncode, 1)
                    self.assertEqual(len(self.chip.events), cut)
                    self.chip.fails_at = None
                    self.expect_flashed(self.flash(probe, "--node", "3"))
                    self.expect_complete(probe)
                    self.assertEqual(bytes(self.chip.flash), flashed)

    def test_a_chip_with_read_protection_is_left_as_it_is(self):
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                self.chip.options = 0x0FFF55EC
                self.expect_failed(self.flash(probe), "found the read protection 0x55, expected 0xAA" if probe == "stlink"
                                   else "found a chip whose read protection is on")
                self.assertEqual(self.chip.events, [])

    def test_another_chip_is_left_as_it_is(self):
        self.chip.device_id = 0x419
        self.expect_failed(self.flash("stlink"), "found a chip with the device id 0x419, expected 0x413")
        self.assertEqual(self.chip.events, [])

    def test_an_elf_file_is_a_bootloader_too(self):
        self.write("boot.elf", elf([(FLASH, BOOTLOADER[:180]), (FLASH + 180, BOOTLOADER[180:])]))
        self.expect_flashed(self.flash("uart", bootloader="boot.elf"))
        self.expect_complete("uart")

    def test_without_the_option_the_bootloader_lies_beside_the_image(self):
        self.write("proleg_boot_stm32f405.bin", OTHER_BOOTLOADER)
        with self.connected("dfu") as (words, environment):
            self.expect_flashed(self.run_flash(*words, str(self.folder / "module.pimg"), **environment))
        self.expect_complete("dfu", bootloader=OTHER_BOOTLOADER)

    def commands(self, result):
        """The lines with which a run shows its commands."""
        return re.findall(r"^    ((?:openocd|dfu-util|stm32flash) .*)", result.stdout, re.MULTILINE)

    def test_a_dry_run_shows_what_a_run_does_and_does_nothing(self):
        for probe in PROBES:
            with self.subTest(probe=probe):
                self.chip = Stm32F405()
                with self.connected(probe) as (words, environment):
                    words = [*words, "--bootloader", "boot.bin", "--node", "3", "module.pimg"]
                    dry = self.run_flash("--dry-run", *words, **environment)
                    self.expect_flashed(dry)
                    self.assertEqual((self.chip.events, dry.stderr), ([], ""))
                    result = self.run_flash(*words, **environment)
                self.expect_flashed(result)
                self.assertEqual(self.commands(dry), self.commands(result))
                self.assertTrue(self.commands(dry))
                self.assertEqual("flash erase_address 0x08020000 131072" in dry.stdout, probe in SWD_PROBES)

    # The chip shows a wrong command: without that, the other tests would prove nothing.

    def script(self):
        """As the dry run shows it."""
        result = self.run_flash("--bare", "--probe", "stlink", "--dry-run", "--bootloader", "boot.bin", "module.pimg")
        lines = result.stdout.split("bare.tcl:\n")[1].split("write all:\n")[0]
        return re.sub(r"^    ", "", lines, flags=re.MULTILINE)

    def test_openocd_refuses_a_script_with_a_wrong_word(self):
        for right, wrong in (("flash erase_address", "flash erase_adress"), ("verify_image", "verify_imag"),
                             ("flash protect 0 0 1 on", "flash protect 0 0 1 onn"),
                             ("stm32f2x options_write 0", "stm32f2x option_write 0"),
                             ("image.pimg 0x08020000 bin", "image.pimg 0x08020000 raw"),
                             ("[mrw 0x40023C14]", "[mrww 0x40023C14]"), (None, None)):
            with self.subTest(wrong=wrong):
                self.chip = Stm32F405()
                script = self.script()
                work = Path(tempfile.mkdtemp(dir=self.folder))
                (work / "bare.tcl").write_text(script.replace(right, wrong) if right else script)
                (work / "bootloader.bin").write_bytes(BOOTLOADER)
                (work / "image.pimg").write_bytes(IMAGE)
                with self.connected("stlink"):
                    result = subprocess.run("openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -f bare.tcl".split(),
                                            cwd=work, env=self.environment, capture_output=True, timeout=LONGEST)
                self.assertTrue(right is None or right in script)
                self.assertEqual(result.returncode != 0, right is not None, result.stderr)

    def test_the_others_name_a_wrong_option(self):
        for probe, wrong in (("dfu", "--sett"), ("uart", "-Z")):
            for is_wrong in (False, True):
                with self.subTest(probe=probe, is_wrong=is_wrong), self.connected(probe) as (words, environment):
                    dry = self.run_flash("--dry-run", *words, "--bootloader", "boot.bin", "module.pimg", **environment)
                    command = self.commands(dry)[0].split()
                    command[1:1] = [wrong] if is_wrong else []
                    result = subprocess.run(command, cwd=self.folder, capture_output=True, timeout=LONGEST, text=True,
                                            env={**self.environment, **environment})
                    self.assertEqual(bool(WRONG_OPTION.search(result.stderr)), is_wrong, result.stderr)
                    (self.folder / "present.bin").unlink(missing_ok=True)

    # --- what a person can do about a failure

    def test_a_missing_program_is_named_with_its_package(self):
        (self.folder / "empty").mkdir()
        for probe, name in (("stlink", "openocd"), ("dfu", "dfu-util"), ("uart", "stm32flash")):
            with self.subTest(probe=probe), self.connected(probe) as (words, environment):
                result = self.run_flash(*words, "--bootloader", "boot.bin", "module.pimg", **environment,
                                        PATH=str(self.folder / "empty"))
                self.expect_failed(result, f"'sudo apt install {name}' installs it")

    def test_openocd_that_ends_well_without_having_run_the_script_is_an_error(self):
        for script in ("shutdown\n", NO_PROBE + "proc init {} {}\nproc reset {args} { shutdown }\n"):
            with self.subTest(script=script):
                self.set_interface(script)
                result = self.run_flash("--bare", "--probe", "stlink", "--bootloader", "boot.bin", "module.pimg")
                self.expect_failed(result, "")
                self.assertNotIn("flashed", result.stdout)

    def test_a_missing_probe_is_named(self):
        words = ("--bootloader", "boot.bin", "module.pimg", "--bare")
        self.expect_failed(self.run_flash(*words, "--probe", "stlink"), "found no ST-LINK")
        # A serial number that no probe of this computer has.
        for driver, message in (("jlink", "found no J-Link that can be opened"),
                                ("cmsis-dap", "found no CMSIS-DAP probe that can be opened")):
            with self.subTest(driver=driver):
                self.set_interface(f"adapter driver {driver}\nadapter serial 000000000\n")
                result = self.run_flash(*words, "--probe", driver)
                self.expect_failed(result, message)
                self.expect_failed(result, "70-proleg.rules")
        self.expect_failed(self.run_flash(*words, "--probe", "dfu"), "found no DFU device")
        self.expect_failed(self.run_flash(*words, "--probe", "dfu", PROLEG_FAKE_DFU="/missing"), "70-proleg.rules")
        self.expect_failed(self.run_flash(*words, "--probe", "uart", "--port", "/dev/missing"), "found no file", status=2)

    def test_a_chip_that_does_not_answer_is_named(self):
        main, line = os.openpty()
        self.addCleanup(os.close, main)
        self.addCleanup(os.close, line)
        result = self.run_flash("--bare", "--probe", "uart", "--port", os.ttyname(line), "--bootloader", "boot.bin",
                                "module.pimg")
        self.expect_failed(result, "found no answer on the line, expected the ROM bootloader: set BOOT0 to high")

    def test_any_board_is_taken_that_image_and_bootloader_name(self):
        for board, name in ((3, "board 3 (weact-stm32f405)"), (77, "board 77")):
            self.write("other.pimg", image(board=board))
            self.write("other.bin", bootloader_of_board(board))
            result = self.run_flash("--bare", "--dry-run", "--probe", "dfu", "--bootloader", "other.bin", "other.pimg")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"other.pimg, {name}, for 0x08020000", result.stdout)

    def test_bad_input_starts_nothing(self):
        self.write("other_board.pimg", image(board=2))
        self.write("boot_3.bin", bootloader_of_board(3))
        self.write("slot_b.pimg", image(address=0x08080200))
        self.write("large.pimg", image(size=90112 - 508))
        self.write("large.bin", program(FLASH, PLACE + 4, seed=4))
        self.write("slot_a.bin", program(SLOT_A, 1000, seed=4))
        self.write("slot_a.elf", elf([(SLOT_A, program(SLOT_A, 1000, seed=4))]))
        good = {"--probe": "dfu", "--bootloader": "boot.bin"}
        for image_name, options, message in (
                ("module.pimg", {"--probe": None}, "--bare: found no --probe, expected --probe stlink, jlink"),
                ("module.pimg", {"--probe": "jtag"}, "--probe: found 'jtag', expected stlink, jlink, cmsis-dap, dfu or uart"),
                ("module.pimg", {"--probe": "uart"}, "--probe: found uart without --port"),
                ("module.pimg", {"--port": "/dev/ttyUSB0"}, "--port: found it without --probe uart"),
                ("module.pimg", {"--node": "0"}, "--node: found '0', expected a node id from 1 to 126"),
                ("module.pimg", {"--node": "127"}, "--node: found '127'"),
                ("module.pimg", {"--node": "x"}, "--node: found 'x'"),
                ("missing.pimg", {}, "missing.pimg: found no file"),
                ("boot.bin", {}, "boot.bin: found a raw binary"),
                ("other_board.pimg", {}, "other_board.pimg: found an image for board 2 (olimex-stm32-p405), expected one for "
                 "board 1 (reference), as the bootloader boot.bin"),
                ("module.pimg", {"--bootloader": "boot_3.bin"}, "module.pimg: found an image for board 1 (reference), "
                 "expected one for board 3 (weact-stm32f405), as the bootloader boot_3.bin"),
                ("slot_b.pimg", {}, "the address 0x08020200"),
                ("large.pimg", {}, "large.pimg: found"),
                ("module.pimg", {"--bootloader": None}, "proleg_boot_stm32f405.bin: found no file"),
                ("module.pimg", {"--bootloader": "module.pimg"}, "module.pimg: found an image, expected a bootloader"),
                ("module.pimg", {"--bootloader": "large.bin"}, "large.bin: found 32772 bytes, expected at most 32768"),
                ("module.pimg", {"--bootloader": "slot_a.bin"}, "slot_a.bin: found the reset vector 0x08020011"),
                ("module.pimg", {"--bootloader": "slot_a.elf"}, "slot_a.elf: found a program with bytes from 0x08020000"),
        ):
            with self.subTest(message=message):
                words = [word for name, value in {**good, **options}.items() if value for word in (name, value)]
                result = self.run_flash("--bare", *words, image_name)
                self.expect_failed(result, message, status=2)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertEqual(result.stdout, "")


if __name__ == "__main__":
    FlashBare.libusb = Path(sys.argv.pop()).resolve()
    FlashBare.programs = Path(sys.argv.pop()).resolve()
    FlashBare.source = Path(sys.argv.pop()).resolve()
    unittest.main()
