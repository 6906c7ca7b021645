"""One run of the virtual machine: starts QEMU, passes on what the command writes, and finds out how the run ended."""

import ctypes
import os
import re
import resource
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import time

import guest
from kernel import Failure

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PR_SET_PDEATHSIG = 1  # linux/prctl.h
# A guest that has reported the end of the command: time to receive the rest of a long output, after each part of it.
DRAIN_TIMEOUT_S = 30
# KVM that is offered but does not work: QEMU ends, or the guest stands still. One that works boots in 2 s.
KVM_BOOT_TIMEOUT_S = 20


class Stopped(Exception):
    """A signal that ends the lab."""

    def __init__(self, number):
        super().__init__(number)
        self.number = number


class KvmFailed(Exception):
    """The guest did not boot with KVM."""


class Machine:
    """QEMU with its channels: `out` and `err` of the command, `reports` of guest.sh, `log` of the kernel and of QEMU."""

    NAMES = ("out", "err", "reports", "log")

    def __init__(self, kernel, options, use_kvm):
        self.options = options
        self.use_kvm = use_kvm
        self.started = time.monotonic()
        self.log = bytearray()
        self.reports = bytearray()
        self.passed_on = {"out": 0, "err": 0}
        results = options.results.resolve() if options.results else None
        job = guest.job_script(kernel, options.command, results, options.bluetooth, options.virtual_time)
        disk_content = guest.build_memory_disk(kernel, job)

        pairs = [socket.socketpair() for _ in self.NAMES]
        disk = os.memfd_create("lab")
        with os.fdopen(disk, "wb", closefd=False) as file:
            file.write(disk_content)
        inherited = [theirs.fileno() for _, theirs in pairs]
        command = guest.qemu_command(kernel, options.memory, disk, inherited, results, self.use_kvm,
                                     options.virtual_time)
        try:
            # A session of its own: Ctrl-C reaches this program, which then ends QEMU.
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=inherited[3], stderr=inherited[3],
                pass_fds=[disk, *inherited], start_new_session=True, preexec_fn=prepare_child)
        except OSError as error:
            raise Failure(f"{command[0]} could not be started: {error.strerror}; its package is qemu-system-x86") from None
        finally:
            os.close(disk)
            for _, theirs in pairs:
                theirs.close()
        self.selector = selectors.DefaultSelector()
        for name, (ours, _) in zip(self.NAMES, pairs):
            self.selector.register(ours, selectors.EVENT_READ, name)

    def receive(self, timeout_s):
        """Waits for bytes and passes them on. False if nothing more can come."""
        for key, _ in self.selector.select(timeout_s):
            try:
                content = key.fileobj.recv(1 << 16)
            except ConnectionResetError:
                content = b""
            if not content:
                self.selector.unregister(key.fileobj)
                key.fileobj.close()
            elif key.data == "log":
                self.log += content
            elif key.data == "reports":
                self.reports += content
            else:
                self.passed_on[key.data] += len(content)
                write_all(1 if key.data == "out" else 2, content)
        return bool(self.selector.get_map())

    def report(self, name):
        """Words of a report that the guest has made; None if it has not."""
        for line in bytes(self.reports).decode(errors="replace").split("\n")[:-1]:
            words = line.split(" ")
            if words[0] == name:
                return words[1:]
        return None

    def run_until_end(self):
        """The command's status; Failure if there is none."""
        deadline = self.started + self.options.timeout
        has_started = False
        while True:
            now = time.monotonic()
            if now >= deadline:
                raise Failure(self.describe_timeout())
            is_open = self.receive(min(deadline - now, 1))
            if self.report("started") is not None and not has_started:
                has_started = True
                self.note("the command was started")
            if self.report("failed"):
                raise Failure("the guest could not be set up: " + " ".join(self.report("failed")))
            ended = self.report("ended")
            if ended:
                self.note("the command ended")
                self.drain({"out": int(ended[1]), "err": int(ended[2])})
                return int(ended[0])
            if self.use_kvm and not self.reports and (not is_open or now > self.started + KVM_BOOT_TIMEOUT_S):
                raise KvmFailed
            if not is_open:
                raise Failure(self.describe_end())

    def drain(self, counts):
        """Receives all that the command has written."""
        deadline = time.monotonic() + DRAIN_TIMEOUT_S
        while any(self.passed_on[name] < count for name, count in counts.items()):
            before = dict(self.passed_on)
            is_open = self.receive(0.1)
            if self.passed_on != before:
                deadline = time.monotonic() + DRAIN_TIMEOUT_S
            if not is_open or time.monotonic() > deadline:
                raise Failure(f"found {self.passed_on} bytes of output, expected {counts}")

    def describe_timeout(self):
        seconds = f"{self.options.timeout:g} s"
        if self.report("started") is not None:
            return f"the command had not ended after {seconds} (--time-out)"
        return f"the guest had not started the command after {seconds} (--time-out)"

    def describe_end(self):
        """Why QEMU ended before the command."""
        log = bytes(self.log).decode(errors="replace")
        failed = re.search(r"^lab: ([^\r\n]*)", log, re.MULTILINE)
        if failed:
            return f"the guest could not be set up: {failed[1]}"
        panic = re.search(r"Kernel panic - not syncing: (.*)", log)
        if panic:
            cause = re.search(r"(?:BUG|Oops|general protection fault|kernel BUG at)[^\r\n]*", log)
            return f"the guest's kernel panicked: {panic[1].strip()}" + (f" ({cause[0].strip()})" if cause else "")
        try:
            status = self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            status = None
        lines = [line.strip() for line in log.splitlines() if line.strip()]
        reason = lines[-1] if lines else "it said nothing"
        return f"QEMU ended with status {status} before the command had ended: {reason}"

    def note(self, text):
        """With --verbose: a line with the time, the accelerator, QEMU's time on a core and its memory."""
        if not self.options.verbose:
            return
        words = [f"{time.monotonic() - self.started:.2f} s", "KVM" if self.use_kvm else "TCG"]
        try:
            with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as stat:
                ticks = sum(int(field) for field in stat.read().rsplit(")", 1)[1].split()[11:13])
            words.append(f"{ticks / os.sysconf('SC_CLK_TCK'):.2f} core-seconds")
            with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
                words += [f"{int(peak) // 1024} MB" for peak in re.findall(r"VmHWM:\s+(\d+)", status.read())]
        except OSError:
            pass  # it has ended
        print(f"lab: {text}: {', '.join(words)}", file=sys.stderr)

    def end(self):
        """Ends QEMU. May be called again."""
        self.process.kill()
        self.process.wait()
        # What the kernel wrote last explains a failure.
        while self.selector.get_map() and self.selector.select(0):
            if not self.receive(0):
                break

    def keep_log(self, failure):
        """Writes the log, if that was asked for or if the lab failed; its name then belongs to the message."""
        path = self.options.keep_log
        if path is None and failure:
            descriptor, path = tempfile.mkstemp(prefix="proleg-lab-", suffix=".log")
            os.close(descriptor)
        if path is None:
            return ""
        try:
            with open(path, "wb") as file:
                file.write(self.log)
        except OSError as error:
            return f"; the log could not be kept in {path}: {error.strerror}"
        return f"; log: {path}"


def prepare_child():
    """In the child: it ends when this program is killed, and leaves no core file."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def write_all(descriptor, content):
    while content:
        content = content[os.write(descriptor, content):]


def stop(number, _frame):
    raise Stopped(number)


def end_by_signal(number):
    """Ends this program as the signal does that was caught, so that the caller sees which one it was."""
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    return 128 + number  # not reached, unless the signal is blocked


def run_once(kernel, options, use_kvm):
    machine = Machine(kernel, options, use_kvm)
    try:
        machine.note(kernel.name)
        status = machine.run_until_end()
        machine.note("the guest ended")
        machine.end()
        machine.keep_log(failure=False)
        return status
    except Failure as failure:
        machine.end()
        raise Failure(f"{failure}{machine.keep_log(failure=True)}") from None
    finally:
        machine.end()


def run(kernel, options):
    """Runs options.command in a guest and returns its status. A signal ends the guest, and then this program."""
    for number in SIGNALS:
        signal.signal(number, stop)
    try:
        if not options.no_kvm and not options.virtual_time and guest.kvm_is_usable():
            try:
                return run_once(kernel, options, use_kvm=True)
            except KvmFailed:
                if options.verbose:
                    print("lab: the guest did not boot with KVM", file=sys.stderr)
        return run_once(kernel, options, use_kvm=False)
    except Stopped as stopped:
        return end_by_signal(stopped.number)
    except BrokenPipeError:
        return end_by_signal(signal.SIGPIPE)
