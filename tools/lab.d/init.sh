#!/bin/busybox sh
# The first program of the guest, in the initial memory disk: mounts the host's file system and continues there with
# guest.sh. The folder /lab of the memory disk has busybox, the kernel modules, both scripts and `job`.
export PATH=/bin
/bin/busybox mkdir -p /proc
/bin/busybox --install -s /bin

# fail TEXT: the kernel panics when its first program ends; tools/lab shows the text.
fail() {
  echo "lab: $*"
  exit 1
}

for module in /lab/modules/*; do
  insmod "$module" || fail "the module ${module##*/} could not be loaded"
done

mkdir -p /host
# Each inode is asked for once: the files of the host do not change while a guest reads them.
mount -t 9p -o ro,trans=virtio,version=9p2000.L,msize=262144,cache=loose host /host ||
  fail "the host's file system could not be mounted"
mount -t proc proc /host/proc
mount -t sysfs sysfs /host/sys
mount -t devtmpfs devtmpfs /host/dev
mkdir -p /host/dev/pts /host/dev/shm
mount -t devpts -o mode=620,ptmxmode=666 devpts /host/dev/pts
mount -t tmpfs -o mode=1777 tmpfs /host/dev/shm
mount -t tmpfs -o mode=1777 tmpfs /host/tmp
mount -t tmpfs -o mode=755 tmpfs /host/run
mkdir /host/run/lab
cp -r /bin/busybox /lab/guest.sh /lab/job /host/run/lab
exec switch_root /host /run/lab/busybox sh /run/lab/guest.sh
