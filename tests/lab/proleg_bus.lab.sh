#!/bin/sh
# A simulated robot on vcan0: any CAN program reaches its modules, and so does proleg. (An emulated processor is too slow to
# drive it in real time.)
set -eu
scenario=$PROLEG_LAB_CHECKS/../../sim/scenarios/travelling_wave/uniform.simulation.xml
"$PROLEG_BIN/proleg-bus" "$scenario" --can vcan0 --seconds 110 >bus 2>&1 &
bus=$!
for _ in $(seq 300); do
  ! grep -qs vcan0 bus || break
  sleep 0.1
done

# The modules need some time to boot: the request is repeated.
answer=
for _ in $(seq 50); do
  timeout 30 candump -L -n 1 vcan0,583:7FF >answer &
  candump=$!
  sleep 0.2
  cansend vcan0 603#4000100000000000
  sleep 0.3
  if ! kill -0 $candump 2>/dev/null; then
    answer=$(sed 's/.* //' answer)
    break
  fi
  kill $candump
done
echo "answer: $answer"
[ "$answer" = "583#4300100092010200" ]

"$PROLEG_BIN/proleg-scan" --bus vcan0 >scan
cat scan
grep -q '^5 nodes' scan
kill $bus
