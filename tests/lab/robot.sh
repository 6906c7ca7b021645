# For checks that drive simulated robots: source this file. The clock of the lab is the number of the guest's instructions, so
# the robots keep real time. They float (floating/): the physics of a floor would take most of the instructions.
scenarios=$PROLEG_LAB_CHECKS/../../sim/scenarios
floating=$PROLEG_LAB_CHECKS/floating
seconds=${PROLEG_LAB_SECONDS:-2}  # of gait

# read_ahead PROGRAM...: reads them and their libraries, so that they do not wait for a file while a robot moves
read_ahead() {
  for program; do
    echo "$program"
    ldd "$program" | sed -n 's/.*[[:space:]]\(\/[^ ]*\) (0x.*/\1/p'
  done | sort -u | xargs cat >/dev/null
}

# wait_for SECONDS COMMAND...: until the command succeeds
wait_for() {
  limit=$1
  shift
  for _ in $(seq $((limit * 5))); do
    ! "$@" || return 0
    sleep 0.2
  done
  echo "found after $limit s that this has not happened: $*"
  return 1
}

# start_bus SCENARIO OPTION...: a simulated robot, as the process $bus, whose output is in the file `bus`
start_bus() {
  "$PROLEG_BIN/proleg-bus" "$@" >bus 2>&1 &
  bus=$!
  wait_for 30 grep -qs -- '--bus' bus
}
stop_bus() {
  kill -TERM "$bus"
  wait "$bus"
  # If the guest were too slow, the checks would show less than they say.
  ! grep 'stood still' bus
}

# member NAME FILE: a member of a JSON object that proleg has printed
member() { sed -n "s/^ *\"$1\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}$/\1/p" "$2"; }

# expect WHAT FOUND EXPECTED
expect() {
  [ "$2" = "$3" ] || {
    echo "$1: found $2, expected $3"
    return 1
  }
}

# figure TEXT: printed also if the check passes
figure() { echo "$*" >>figures; }
