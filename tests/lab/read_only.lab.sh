#!/bin/sh
# In the lab all files of the computer are read-only, and /tmp and /run are empty and writable.
set -eu
# refuses FILE: it cannot be written
refuses() {
  if (: >"$1") 2>/dev/null; then
    echo "found that $1 can be written, expected a read-only file system"
    exit 1
  fi
}
refuses "$PROLEG_LAB_CHECKS/written"
refuses "$PROLEG_LAB_CHECKS/README.md"
refuses /etc/passwd
refuses /written
mkdir /tmp/lab_check /run/lab_check
rmdir /tmp/lab_check /run/lab_check
test -r "$PROLEG_LAB_CHECKS/README.md"
