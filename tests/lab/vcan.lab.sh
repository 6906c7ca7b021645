#!/bin/sh
# vcan0 carries frames from cansend to candump, in their order.
set -eu
timeout 30 candump -L -n 3 vcan0 >log &
candump=$!
# It receives as soon as its socket is bound: /proc/net/can lists the receivers of vcan0.
for _ in $(seq 300); do
  ! grep -qs vcan0 /proc/net/can/rcvlist_all || break
  sleep 0.1
done
cansend vcan0 603#4000100000000000
cansend vcan0 080#
cansend vcan0 12345678#0123
wait $candump
sed 's/.* //' log >frames
printf '%s\n' '603#4000100000000000' '080#' '12345678#0123' | diff - frames
