#!/bin/sh
# proleg doctor with interfaces of a real kernel: what the kernel says of them, also with a robot behind one.
set -eu
. "$PROLEG_LAB_CHECKS/robot.sh"

# expect_finding CODE BUS: the first one
expect_finding() {
  "$PROLEG_BIN/proleg-doctor" --bus "$2" --json >report || true
  found=$(sed -n 's/.*"code": "\(.*\)",/\1/p' report | head -n 1)
  echo "$2: ${found:-none}"
  [ "${found:-none}" = "$1" ] || { cat report; exit 1; }
}

expect_finding no_interface can77
expect_finding wrong_kind lo
ip link add dev vdoctor type vcan
expect_finding interface_down vdoctor
ip link set vdoctor up
expect_finding nobody_answers vdoctor
ip link set vdoctor txqueuelen 10

start_bus "$floating/five.simulation.xml" --can vdoctor
expect_finding short_queue vdoctor
ip link set vdoctor txqueuelen 1000
expect_finding none vdoctor
stop_bus
ip link delete vdoctor
