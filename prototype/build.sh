#!/bin/sh -e
# Builds the prototype's benchmark in the folder of this script.
cd "$(dirname "$0")"
kernel() {
  g++ -std=c++20 -O2 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wno-psabi -Wall -Wextra -Werror $3 -I.. -DKERNEL=kernel_$1_$2 -DWIDTH=$2 -DNAME="\"$1 x $2\"" -c kernel.cpp -o k_$1_$2.o
}
kernel base 2 -msse2 & kernel avx2 4 -mavx2; kernel avx512 8 -mavx512f; wait
for f in ode_world contact_friction engine hinge_motor step_memory; do
  [ -f ode_$f.o ] || g++ -std=c++20 -O2 -DNDEBUG -ffp-contract=off -I.. -I/usr/include/eigen3 $(pkg-config --cflags ode) -c ../sim/ode/$f.cpp -o ode_$f.o
done
g++ -std=c++20 -O2 -Wno-psabi -I.. -I/usr/include/eigen3 bench.cpp k_*.o ode_*.o $(pkg-config --libs ode) -o bench
