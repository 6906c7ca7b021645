#!/bin/sh
# A robot over Bluetooth: scan, set and drive. If the adapter at the robot dies, or the radio link stands still, drive ends and
# says why in its last line, and the joints hold their safe pose. The robot can be used again afterwards.
set -eu
. "$PROLEG_LAB_CHECKS/robot.sh"
read_ahead "$PROLEG_BIN/proleg-bus" "$PROLEG_BIN/proleg-drive" "$PROLEG_BIN/proleg-scan"
far=$(hciconfig hci1 | sed -n 's/.*BD Address: \([0-9A-F:]*\).*/\1/p')
radio=bluetooth:$far/1
wire=tcp:127.0.0.1:20001

start_adapter() {
  "$PROLEG_LAB_CHECKS/rfcomm_bridge.py" "$far" 1 20001 >adapter 2>&1 &
  adapter=$!
  wait_for 60 grep -qs listens adapter
}

# finds_robot: over the radio. The first connection after one that broke can fail (README.md).
scans() { "$PROLEG_BIN/proleg-scan" --bus "$radio" >scan 2>&1 && grep -q '^5 nodes' scan; }
finds_robot() { wait_for 30 scans || { cat scan; return 1; }; }

start_drive() {
  powered=$(grep -c 'has power' bus || true)
  "$PROLEG_BIN/proleg-drive" "$scenarios/travelling_wave/uniform.simulation.xml" --bus "$radio" --seconds 60 \
    >out 2>errors &
  drive=$!
  wait_for 30 has_power
  wait_for 30 walks
}
# As `proleg bus --verbose` prints it: all joints have got power once more.
has_power() { [ "$(grep -c 'has power' bus)" -ge $((powered + 5)) ]; }
# The joints have ramped in, and half a second of gait is over.
walks() { [ "$("$PROLEG_BIN/proleg-get" 1 0x2001:7 --bus "$wire" | sed -n 's/.*(\([0-9]*\)).*/\1/p')" -gt 50 ]; }
holds() { "$PROLEG_BIN/proleg-scan" --bus "$wire" | grep -c 'quick stop' | grep -q '^5$'; }
has_ended() { ! kill -0 $drive 2>/dev/null; }

# ends_safely WHAT
ends_safely() {
  wait_for 30 has_ended
  status=0
  wait $drive || status=$?
  cat out errors
  expect "status of drive, $1" $status 1
  sed -i '/heartbeat of the host lost/d; /warning/d' errors
  tail -n 1 errors | grep 'radio connection\|connection is lost\|stop by themselves'
  wait_for 10 holds
  figure "$1: $(tail -n 1 errors)"
}

start_bus "$floating/five.simulation.xml" --tcp 20001 --verbose
start_adapter
finds_robot
"$PROLEG_BIN/proleg-set" 3 0x6080 300 --bus "$radio"
"$PROLEG_BIN/proleg-get" 3 0x6080 --bus "$wire" | tee value
grep -q '= 300' value

"$PROLEG_BIN/proleg-drive" "$scenarios/travelling_wave/uniform.simulation.xml" --bus "$radio" --seconds 1 --json >json
cat json
expect differences "$(member differences json)" 0
expect frames_missing "$(member frames_missing json)" 0

start_drive
kill -KILL $adapter
ends_safely "the adapter is switched off"
start_adapter
finds_robot

# The time-outs of a link that stands still take long.
if [ "$seconds" -ge 60 ]; then
  start_drive
  kill -STOP "$(pidof btvirt)"
  ends_safely "the radio link stands still"
  kill -CONT "$(pidof btvirt)"
  kill -KILL $adapter
  start_adapter
  finds_robot
  "$PROLEG_BIN/proleg-drive" "$scenarios/travelling_wave/uniform.simulation.xml" --bus "$radio" --seconds 1 --json >json
  expect "differences after all" "$(member differences json)" 0
fi
stop_bus
