# The first process of the guest, on the host's file system: prepares interfaces, runs the command and reports how it
# ended. `job` sets:
#   folders        absolute folders below /tmp or /run that must stay visible, one a line
#   results        the folder for results, or nothing
#   kernel         folder with lib/modules
#   bluetooth      yes or no
#   virtual_time   yes or no
# and defines the function `run_command`, which starts the command in its folder and environment.
#
# busybox runs this script with its own mount, dd and so on, which saves loading programs; those of the host are named
# by their paths.
#
# The ports to the host: the first and second carry the command's output and errors, the third the lines that report writes.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
lab=/run/lab
. $lab/job

# port NUMBER: its device, as soon as the kernel has found it
port() {
  while :; do
    for device in /dev/vport*p"$1"; do
      [ ! -c "$device" ] || { echo "$device"; return; }
    done
    sleep 0.02
  done
}
out=$(port 1)
err=$(port 2)
exec 3>"$(port 3)"
report() { echo "$*" >&3; }
report booted

# fail TEXT: what the lab itself could not do
fail() {
  report "failed $*"
  sleep 60  # the host ends the guest
}

# What /run and /tmp hide is visible below this folder.
mkdir $lab/host
mount --bind / $lab/host || fail "the host's file system could not be bound"
echo "$folders" | while read -r folder; do
  [ -z "$folder" ] || { mkdir -p "$folder" && mount --bind "$lab/host$folder" "$folder"; } ||
    fail "$folder could not be made visible"
done
if [ -n "$results" ]; then
  mkdir -p "$results" 2>/dev/null
  mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144,cache=mmap results "$results" ||
    fail "$results could not be mounted"
fi

mkdir $lab/bin
# The kernel, and scripts, load further modules by this program.
cat >$lab/bin/modprobe <<END
#!/bin/sh
exec /sbin/modprobe -d "$lab/host$kernel" "\$@"
END
chmod +x $lab/bin/modprobe
echo $lab/bin/modprobe >/proc/sys/kernel/modprobe
hostname lab
/sbin/ip link set lo up
/sbin/ip link add vcan0 type vcan && /sbin/ip link set vcan0 up || fail "vcan0 could not be added"

# Two virtual controllers, hci0 and hci1, that reach each other: up, connectable and discoverable.
if [ "$bluetooth" = yes ]; then
  $lab/bin/modprobe -a hci_vhci rfcomm || fail "the modules of Bluetooth could not be loaded"
  /usr/bin/btvirt -l2 -B </dev/null >$lab/btvirt.log 2>&1 &
  for controller in hci0 hci1; do
    for _ in $(seq 300); do
      [ ! -e /sys/class/bluetooth/$controller ] || break
      sleep 0.1
    done
    /usr/bin/hciconfig $controller up piscan || fail "$controller could not be brought up"
  done
fi

# Virtual time jumps to the next timer while the guest is idle, also while it waits for a file of the host: minutes can pass so.
# With this process a jump is 20 ms at most, and costs the host as much time as an answer takes.
if [ "$virtual_time" = yes ]; then
  nice -n 19 $lab/busybox sh -c 'while sleep 0.02; do :; done' </dev/null >/dev/null 2>&1 3>&- &
fi

mkfifo $lab/out $lab/err
# dd, since it counts: the host knows by the counts that it has received everything.
LC_ALL=C /bin/dd if=$lab/out of="$out" bs=64k 2>$lab/out.count & relays=$!
LC_ALL=C /bin/dd if=$lab/err of="$err" bs=64k 2>$lab/err.count & relays="$relays $!"
report started
(exec 3>&-; run_command) </dev/null >$lab/out 2>$lab/err &
wait $!
status=$?

# Processes that the command left hold its output open.
for process in /proc/[0-9]*; do
  process=${process#/proc/}
  case " 1 $relays " in
    *" $process "*) ;;
    *) kill -9 "$process" 2>/dev/null ;;
  esac
done
wait $relays
[ -z "$results" ] || umount "$results" || umount -l "$results"
# count FILE: bytes, from the last line of dd
count() { sed -n 's/^\([0-9]*\) bytes\{0,1\} .*copied.*/\1/p' "$1"; }
report "ended $status $(count $lab/out.count) $(count $lab/err.count)"
sleep 60
