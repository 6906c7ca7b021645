#!/bin/sh
# A simulated robot on vcan0: any CAN program reaches its modules, and so does proleg.
set -eu
. "$PROLEG_LAB_CHECKS/robot.sh"
start_bus "$floating/five.simulation.xml" --can vcan0

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
stop_bus
