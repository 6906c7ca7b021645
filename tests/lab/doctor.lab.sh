#!/bin/sh
# proleg doctor with interfaces of a real kernel: what the kernel says of them, also with a robot behind one.
set -eu
doctor=$PROLEG_BIN/proleg-doctor
scenario=$PROLEG_LAB_CHECKS/../../sim/scenarios/travelling_wave/uniform.simulation.xml

# expect CODE BUS: the first finding.
expect() {
  "$doctor" --bus "$2" --json >report || true
  found=$(sed -n 's/.*"code": "\(.*\)",/\1/p' report | head -n 1)
  echo "$2: ${found:-none}"
  [ "${found:-none}" = "$1" ] || { cat report; exit 1; }
}

expect no_interface can77
expect wrong_kind lo
ip link add dev vdoctor type vcan
expect interface_down vdoctor
ip link set vdoctor up
expect nobody_answers vdoctor
ip link set vdoctor txqueuelen 10

"$PROLEG_BIN/proleg-bus" "$scenario" --can vdoctor --seconds 110 >bus 2>&1 &
bus=$!
for _ in $(seq 300); do
  ! grep -qs vdoctor bus || break
  sleep 0.1
done
# An emulated processor may be too slow for the answers of the modules: only what the kernel says is compared.
"$doctor" --bus vdoctor --json >report || true
cat report
grep -q '"code": "short_queue"' report
ip link set vdoctor txqueuelen 1000
"$doctor" --bus vdoctor --json >report || true
! grep -q '"code": "short_queue"' report || { cat report; exit 1; }
kill $bus
ip link delete vdoctor
