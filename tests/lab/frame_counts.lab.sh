#!/bin/sh
# A robot that walks: candump on a CAN interface, python-can over slcan on a pseudo terminal and over TCP, and `proleg
# monitor` count the same frames.
set -eu
. "$PROLEG_LAB_CHECKS/robot.sh"
read_ahead "$PROLEG_BIN/proleg-bus" "$PROLEG_BIN/proleg-drive" "$PROLEG_BIN/proleg-monitor" /usr/bin/candump

start_bus "$floating/five.simulation.xml" --can vcan0 --pty --tcp 20000
pty=$(sed -n 's/.*serial:\(.*\)/\1/p' bus)
# The modules boot, and send nothing more until a host configures them.
sleep 1
candump -L vcan0 >log &
for channel in "$pty" socket://127.0.0.1:20000; do
  "$PROLEG_LAB_CHECKS/count_frames.py" "$channel" "count.${channel%%/*}" &
  wait_for 60 test -s "count.${channel%%/*}"
done
"$PROLEG_BIN/proleg-monitor" --bus tcp:127.0.0.1:20000 --json >monitor &
wait_for 60 test -s monitor

"$PROLEG_BIN/proleg-drive" "$scenarios/travelling_wave/uniform.simulation.xml" --bus vcan0 --seconds "$seconds"
cansend vcan0 000#8100
sleep 1
# The monitor asks the modules twice a second. Between two questions no frame is under way.
size=
is_quiet() {
  last=$size
  size=$(wc -c <log)
  [ "$size" = "$last" ]
}
wait_for 10 is_quiet
stop_bus
sleep 1.5

on_bus=$(wc -l <log)
on_pty=$(tail -n 1 count.)
on_tcp=$(tail -n 1 count.socket:)
monitored=0
for frames in $(sed 's/.*"frames": *\([0-9]*\).*/\1/' monitor); do
  monitored=$((monitored + frames))
done
figure "candump $on_bus, pseudo terminal $on_pty, TCP $on_tcp, monitor $monitored frames; $seconds s of gait"
cat figures
expect "frames on the pseudo terminal" "$on_pty" "$on_bus"
expect "frames over TCP" "$on_tcp" "$on_bus"
expect "frames of the monitor" "$monitored" "$on_bus"
# Five state frames and SYNC, every 10 ms.
[ "$on_bus" -gt $((seconds * 600)) ]
