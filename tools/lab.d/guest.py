"""The virtual machine: its memory disk and QEMU's command line."""

import fcntl
import os
import shlex
from pathlib import Path

from kernel import Failure

HERE = Path(__file__).resolve().parent
BUSYBOX = Path("/bin/busybox")
# Loaded in this order before the host's file system is there. Those that are built into a kernel are skipped.
MODULES = ("virtio_pci", "virtio_console", "9pnet_virtio", "9p", "vcan", "can-raw")
# Variables that name files, sockets or screens which the guest does not have.
NOT_PASSED = ("TMPDIR", "TMP", "TEMP", "DISPLAY", "WAYLAND_DISPLAY", "XAUTHORITY", "XDG_RUNTIME_DIR", "SSH_AUTH_SOCK",
              "SSH_AGENT_PID", "DBUS_SESSION_BUS_ADDRESS", "GPG_AGENT_INFO", "OLDPWD", "_", "SHLVL")
# A panic or an oops ends the machine. The others save time at the boot.
KERNEL_OPTIONS = ("console=ttyS0 quiet panic=-1 oops=panic "
                  "mitigations=off rodata=off audit=0 lsm=capability tsc=reliable no_timer_check")
KVM_GET_API_VERSION, KVM_CREATE_VM = 0xAE00, 0xAE01  # linux/kvm.h


def memory_disk(files):
    """A cpio archive of files by name, in the format `newc` (Linux: Documentation/driver-api/early-userspace)."""
    folders = {str(parent) for name in files for parent in Path(name).parents if str(parent) != "."}
    entries = [(name, 0o040755, b"") for name in sorted(folders)]
    entries += [(name, 0o100755, content) for name, content in files.items()]
    entries.append(("TRAILER!!!", 0, b""))
    archive = bytearray()
    for number, (name, mode, content) in enumerate(entries, 1):
        fields = [number, mode, 0, 0, 1, 0, len(content), 0, 0, 0, 0, len(name) + 1, 0]
        archive += b"070701" + b"".join(b"%08X" % field for field in fields) + name.encode() + b"\0"
        archive += b"\0" * (-len(archive) % 4) + content
        archive += b"\0" * (-len(archive) % 4)
    return bytes(archive)


def job_script(kernel, command, results, bluetooth, virtual_time=False):
    """What guest.sh shall do."""
    here = os.getcwd()
    checkout = HERE.parent.parent
    folders = [path for path in dict.fromkeys([here, str(checkout)]) if path.startswith(("/tmp/", "/run/"))]
    environment = {name: value for name, value in os.environ.items() if name not in NOT_PASSED}
    environment.update({"PROLEG_LAB": kernel.release, "TMPDIR": "/tmp"})
    environment["PATH"] = "/run/lab/bin:" + os.environ.get("PATH", "/usr/local/bin:/usr/bin:/bin") + ":/usr/sbin:/sbin"
    if results:
        environment["PROLEG_LAB_RESULTS"] = str(results)
    words = [*(f"{name}={value}" for name, value in environment.items()), *command]
    return "\n".join([
        f"folders={shlex.quote(chr(10).join(folders))}",
        f"results={shlex.quote(str(results or ''))}",
        f"kernel={shlex.quote(str(kernel.folder))}",
        f"bluetooth={'yes' if bluetooth else 'no'}",
        f"virtual_time={'yes' if virtual_time else 'no'}",
        f"run_command() {{ cd {shlex.quote(here)} && exec /usr/bin/env -i {shlex.join(words)}; }}", ""])


def build_memory_disk(kernel, job):
    try:
        busybox = BUSYBOX.read_bytes()
    except OSError:
        raise Failure(f"found no {BUSYBOX}, expected the package busybox-static") from None
    files = {"init": (HERE / "init.sh").read_bytes(), "bin/busybox": busybox,
             "lab/guest.sh": (HERE / "guest.sh").read_bytes(), "lab/job": job.encode("utf-8", "surrogateescape")}
    for number, module in enumerate(kernel.modules(MODULES)):
        files[f"lab/modules/{number:02}-{Path(module).name}"] = Path(module).read_bytes()
    return memory_disk(files)


def kvm_is_usable():
    try:
        device = os.open("/dev/kvm", os.O_RDWR | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        if fcntl.ioctl(device, KVM_GET_API_VERSION, 0) != 12:
            return False
        os.close(fcntl.ioctl(device, KVM_CREATE_VM, 0))
        return True
    except OSError:
        return False
    finally:
        os.close(device)


def qemu_command(kernel, memory_mb, disk, channels, results, use_kvm, virtual_time=False):
    """QEMU's command line. `disk`: descriptor of the memory disk. `channels`: descriptors of the sockets for the command's
    output, its errors, the reports, and the kernel's log. `virtual_time`: not with use_kvm."""
    accelerators = ["kvm", "tcg"] if use_kvm else ["tcg"]
    command = ["qemu-system-x86_64", "-M", "q35", "-cpu", "max", "-m", str(memory_mb), "-smp", "1"]
    for accelerator in accelerators:
        command += ["-accel", accelerator]
    if virtual_time:
        # One instruction a nanosecond. Time in which the processor is idle is skipped.
        command += ["-icount", "shift=0,sleep=off,align=off", "-rtc", "clock=vm"]
    command += ["-nodefaults", "-no-user-config", "-display", "none", "-no-reboot",
                "-kernel", str(kernel.vmlinux), "-initrd", f"/proc/self/fd/{disk}",
                "-append", KERNEL_OPTIONS,
                "-fsdev", "local,id=host,path=/,security_model=none,readonly=on,multidevs=remap",
                "-device", "virtio-9p-pci,fsdev=host,mount_tag=host"]
    if results:
        path = str(results).replace(",", ",,")
        command += ["-fsdev", f"local,id=results,path={path},security_model=none,multidevs=remap",
                    "-device", "virtio-9p-pci,fsdev=results,mount_tag=results"]
    output, errors, reports, log = channels
    command += ["-chardev", f"socket,id=log,fd={log}", "-serial", "chardev:log", "-device", "virtio-serial-pci"]
    for number, (name, channel) in enumerate([("out", output), ("err", errors), ("reports", reports)], 1):
        command += ["-chardev", f"socket,id={name},fd={channel}",
                    "-device", f"virtserialport,chardev={name},nr={number}"]
    return command
