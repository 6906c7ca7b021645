#!/bin/sh -e
cd "$(dirname "$0")/../sim/reduced"
kernel() { g++ -std=c++20 -O2 -ffp-contract=off $FLAGS -Wno-psabi -Wall -Wextra -Werror $2 -I../.. -c kernel_$1.cpp -o /tmp/sp_k_$1.o; }
kernel base -msse2 & kernel avx2 -mavx2; kernel avx512 -mavx512f; wait
for f in chain_batch reduced_world spatial_batch spatial_chain spatial_world planar_chain ../../shared/computer/errors/input_error ../../shared/computer/text/text; do
  o=/tmp/sp_f_$(basename $f).o
  [ $o -nt $f.cpp ] && [ -z "$ALL" ] || g++ -std=c++20 -O2 -ffp-contract=off -I../.. -I/usr/include/eigen3 -Wno-psabi -c $f.cpp -o $o; done
cd ../../prototype
g++ -std=c++20 -O2 -Wno-psabi -I.. -I/usr/include/eigen3 bench_worlds.cpp /tmp/sp_k_*.o /tmp/sp_f_*.o ode_*.o $(pkg-config --libs ode) -o bench_worlds
