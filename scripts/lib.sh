# SPDX-License-Identifier: Apache-2.0
# What the scripts share; to be sourced by bash. Sets `project`, the top of the source tree.

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# fail SENTENCE...: says why on stderr and ends the script.
fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# print_help: the comment at the head of the script that runs, which is its help text.
print_help() {
  sed -n '3,/^[^#]/{/^#/!d;s/^# \{0,1\}//;p}' "$0"
}

# packages_of GROUP...: the packages of these groups of packages.txt.
packages_of() {
  local group
  for group in "$@"; do
    sed -n "/^# $group:/,/^\$/{/^#/d;/^\$/d;p}" "$project/scripts/packages.txt"
  done
}

# provided_packages: what the installed packages stand in for, one a line. (Node.js of other
# origin than Debian's brings npm, and refuses the package of that name.)
provided_packages() {
  dpkg-query -W -f='${db:Status-Status} ${Provides}\n' | sed -n 's/^installed //p' |
    tr ',' '\n' | sed 's/[[:space:]]*(.*//; s/[[:space:]]//g'
}

# missing_packages GROUP...: those of them that are neither installed nor provided.
missing_packages() {
  local package status provided
  provided=$(provided_packages)
  for package in $(packages_of "$@"); do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || grep -qxF -e "$package" <<<"$provided" || echo "$package"
  done
}

# as_root COMMAND...: runs it as root; status 126 when there is no way to.
as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    return 126
  fi
}

# use_ccache: makes CMake configure with ccache where it is installed.
use_ccache() {
  command -v ccache >/dev/null || return 0
  export CMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER:-ccache}
  export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-ccache}
}

# install_packages GROUP...: installs what is missing, and nothing else; false when that fails.
install_packages() {
  local missing
  if ! command -v dpkg-query >/dev/null; then
    echo "This is not Debian: make sure that you have what these packages hold:" \
      $(packages_of "$@") >&2
    return 0
  fi
  mapfile -t missing < <(missing_packages "$@")
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
    echo "Neither root nor sudo. As root, run:" \
      "apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
    return 1
  fi
  as_root apt-get update -qq &&
    as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# prepare_emulator: fetches the kernel of the emulated CPUs, unless that was done before.
prepare_emulator() {
  local emulator=$project/tests/emulator/run-on-emulated-cpu
  "$emulator" --missing >/dev/null || return 0
  "$emulator" --prepare || { as_root apt-get update -qq && "$emulator" --prepare; }
}

# now_ms: a clock in milliseconds.
now_ms() {
  echo $(($(date +%s%N) / 1000000))
}

# seconds_since MS: the seconds since now_ms said MS, with one decimal.
seconds_since() {
  local tenths=$((($(now_ms) - $1) / 100))
  echo "$((tenths / 10)).$((tenths % 10))"
}
