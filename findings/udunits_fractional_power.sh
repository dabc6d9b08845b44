#!/usr/bin/env bash
# UDUNITS 2.2.28 (Debian 12, udunits-bin and libudunits2-0 2.2.28-5) reads a power that is no whole number as another
# unit, without a message and with exit status 0: "m^0.5" is m^0 times 5, the pure number 5, and "m^1.5" is 5 m. Digits
# behind a name do the same: "m2.5" is 0.5 m2, "m.5" is 5 m.
#
# Why it matters: half powers are no mistake of the author's. The stress intensity "MPa m^0.5" (fracture toughness), the
# scaled distance of blast in square-unpacked form and spectral densities "V/Hz^0.5" are written so every day. What comes
# back is not a refusal but a number with another dimension: "1 MPa m^0.5" is 5e6 Pa, which passes for a stress. A
# program that hands a user's unit to ut_parse() must check for whole powers itself.
#
# Output seen:
#   m^0.5 -> 5 1
#   m^1.5 -> 5 m
#   m.5 -> 5 m
#   m2.5 -> 0.5 m2
#   MPa m^0.5 -> 5000000 m-1.kg.s-2
set -euo pipefail

version=2.2.28-5
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

apt-get download -qq "udunits-bin=$version" "libudunits2-0=$version" "libudunits2-data=$version" 2>/dev/null
for package in ./*.deb; do dpkg -x "$package" unpacked; done
library=$(dirname "$(find unpacked -name 'libudunits2.so.*' -print -quit)")
export LD_LIBRARY_PATH="$PWD/$library"
export UDUNITS2_XML_PATH="$PWD/unpacked/usr/share/xml/udunits/udunits2.xml"

# The unit in base units.
definition() {
  ./unpacked/usr/bin/udunits2 -A -H "$1" -W "" | sed 's/^ *//'
}

changed=0
expect() {
  local got
  got=$(definition "$1")
  echo "$1 -> $got"
  [[ "$got" == "$2" ]] || changed=1
}
expect 'm^0.5' '5 1'
expect 'm^1.5' '5 m'
expect 'm.5' '5 m'
expect 'm2.5' '0.5 m2'
expect 'MPa m^0.5' '5000000 m-1.kg.s-2'

if ((changed)); then
  echo "UDUNITS no longer behaves as described" >&2
  exit 1
fi
echo "as described: powers that are no whole numbers are read as other units"
