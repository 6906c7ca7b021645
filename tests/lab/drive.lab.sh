#!/bin/sh
# proleg drive over a CAN interface of a real kernel, in real time. The travelling wave has the set-points of
# `simulate`. With 20 modules no frame is lost, and the host takes less than a tenth of a core: only with --seconds.
set -eu
. "$PROLEG_LAB_CHECKS/robot.sh"
read_ahead "$PROLEG_BIN/proleg-bus" "$PROLEG_BIN/proleg-drive" /usr/bin/candump

received() { cat /sys/class/net/vcan0/statistics/rx_packets; }
lost() { cat /sys/class/net/vcan0/statistics/*_dropped /sys/class/net/vcan0/statistics/*_errors | sort -u; }

# drive NAME SCENARIO SECONDS MODULES LIKE: `simulate` of the file LIKE says what is right
drive() {
  before=$(received)
  candump -L vcan0 >"$1.log" &
  candump=$!
  wait_for 30 grep -qs vcan0 /proc/net/can/rcvlist_all
  start_bus "$floating/$1.simulation.xml" --can vcan0
  "$PROLEG_LAB_CHECKS/core_share.py" share "$PROLEG_BIN/proleg-drive" "$2" --bus vcan0 --seconds "$3" --json >"$1.json"
  stop_bus
  kill $candump
  wait $candump || true
  cat "$1.json"
  share=$(cat share)
  figure "$4 modules, $3 s: drive took $share % of a core; $(wc -l <"$1.log") frames"
  figure "$(tr -d '\n' <"$1.json" | sed -n 's/.*"answer_ms": *{\([^}]*\)}.*/SDO request to answer, ms: \1/p' | tr -s ' ')"

  expect differences "$(member differences "$1.json")" 0
  expect frames_missing "$(member frames_missing "$1.json")" 0
  expect frames_compared "$(member frames_compared "$1.json")" $(($3 * 100 * $4))
  expect "frames of candump" "$(wc -l <"$1.log")" $(($(received) - before))
  expect "drops and errors of the kernel" "$(lost)" 0
  "$PROLEG_BIN/proleg-simulate" "$5" --seconds "$3" --json >simulated.json
  # The servos get a pulse every 3 ms, those of the simulation every 1 ms.
  expect setpoint_hash "$(member setpoint_hash "$1.json")" "$(member setpoint_hash simulated.json)"
}

drive five "$scenarios/travelling_wave/uniform.simulation.xml" 2 5 "$scenarios/travelling_wave/uniform.simulation.xml"
[ -n "${PROLEG_LAB_SECONDS:-}" ] || exit 0
drive twenty "$scenarios/long_chain/twenty.simulation.xml" "$seconds" 20 "$floating/twenty.simulation.xml"
# Of an emulated core with one instruction a nanosecond, which is slower than any computer that drives a robot.
expect "whole percents of a core, below 10" "$((${share%.*} < 10))" 1
