#!/usr/bin/env bash
# GCC 12.2 (Debian 12, g++-12 12.2.0-14+deb12u1) leaves out every call of a function that does nothing but
# __builtin_prefetch, unless the function has been copied into its caller before the compiler asks what functions do: it
# takes a function without a result and without stores for one without effect. Prefetches written straight into a loop
# stay, and so do those of a function with one statement more. No option warns.
#
# Why it matters: fetching the next block of a field while one is calculated is the textbook cure where a solver waits
# for memory, and one writes it as a function with a few nested loops, called for each direction of the sweep. The
# program then runs as before, and the notes say that prefetching brought nothing; here it brings 14 to 18 %. Only the
# machine code shows it. An empty asm volatile("") in the function keeps the calls.
#
# Output seen (prefetches in the machine code):
#   -O1 function 0, with a statement more 2
#   -O2 function 0, with a statement more 2
#   -O3 function 0, with a statement more 16
set -euo pipefail

version=12.2.0-14+deb12u1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

apt-get download -qq "g++-12=$version" libisl23=0.25-1.1 libmpc3=1.3.1-1 libmpfr6=4.2.0-1 libgmp10=2:6.2.1+dfsg1-1.1 \
  2>/dev/null
for package in ./*.deb; do dpkg -x "$package" unpacked; done
libraries=$(dirname "$(find unpacked -name 'libisl.so.*' -print -quit)")
export LD_LIBRARY_PATH="$PWD/$libraries"
compiler=$(find unpacked -name cc1plus -print -quit)

source_with() {
  cat <<END
static void fetch(double const* const* fields, int count, long first, long layers, long stride) {
  $1
  for (int c = 0; c < count; ++c)
    for (long l = 0; l < layers; ++l) {
      for (long i = 0; i < 32; i += 8) __builtin_prefetch(fields[c] + first + l * stride + i);
      for (long i = 0; i < 32; i += 8) __builtin_prefetch(fields[c] + first + l * stride + i + 64);
    }
}
void along_y(double const* const* fields, int count, long layers) { fetch(fields, count, 0, layers, 32); }
void along_z(double const* const* fields, int count, long layers) { fetch(fields, count, 8, layers, 1024); }
END
}

prefetches() {
  source_with "$2" >sweep.cpp
  "$compiler" -quiet "$1" sweep.cpp -o sweep.s
  grep -c prefetch sweep.s || true
}

changed=0
for level in -O1 -O2 -O3; do
  alone=$(prefetches "$level" "")
  kept=$(prefetches "$level" 'asm volatile("");')
  echo "$level function $alone, with a statement more $kept"
  [[ $alone -eq 0 && $kept -gt 0 ]] || changed=1
done
if [[ $changed -ne 0 ]]; then
  echo "The behaviour has changed." >&2
  exit 1
fi
