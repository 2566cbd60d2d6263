#!/usr/bin/env bash
# doors.sh BUILD_DIR BITS WORK_DIR LANGUAGE...: the C interface from each language, against an installation. BITS is the
# program of tests/portability/digest.cpp. For each: its example is built from its folder and prints what its page says;
# the hashes after 1000 rows are those of C++; and each loads the states of every other, and goes on to the same hashes.
set -euo pipefail
build=$1 cpp=$(realpath -- "$2") work=$3
shift 3
tree=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../..
rm -rf -- "$work"
mkdir -p -- "$work"
cd -- "$work"
for component in headers library c; do
  cmake --install "$build" --prefix "$work/prefix" --component $component >install.log
done
export PKG_CONFIG_PATH LD_LIBRARY_PATH CC=${CC:-cc}
PKG_CONFIG_PATH=$(dirname -- "$(find "$work/prefix" -name rlslab-c.pc)")
LD_LIBRARY_PATH=$(dirname -- "$(find "$work/prefix" -name 'librlslab.so')")
read -ra flags <<<"$(pkg-config --cflags --libs rlslab-c)"
# rustup's, where there is one, is not Debian's
rustc=/usr/bin/rustc
[[ -x $rustc ]] || rustc=rustc

# Builds ./example and ./bits in the folder of the language.
build_c() {
  "$CC" -std=c99 -pedantic -Wall -Wextra -Werror -O2 "$tree/docs/examples/c/main.c" "${flags[@]}" -o example
  "$CC" -std=c99 -pedantic -Wall -Wextra -Werror -O2 "$tree/tests/doors/bits.c" "${flags[@]}" -o bits
  "$CC" "$tree/docs/examples/c/main.c" -I "$work/prefix/include" "$LD_LIBRARY_PATH/librlslab.a" -lstdc++ -lm -o static
  ./static | cmp - <(./example)
  page
}
# The blocks of docs/c.md: the first is a program, whose output the page has; the others are statements.
page() {
  local fragment
  awk '/^```c$/ { file = "page" ++n ".c"; next } /^```$/ { file = "" } file { print > file }' "$tree/docs/c.md"
  "$CC" -std=c99 -pedantic -Wall -Wextra -Werror page1.c "${flags[@]}" -o page
  ./page >page.out
  sed -n '/^```text$/,/^```$/p' "$tree/docs/c.md" | sed '/^```/d' | cmp - page.out
  rm page1.c
  for fragment in page*.c; do
    { echo '#include <rlslab.h>'; echo '#include <stdio.h>'; echo '#include <stdlib.h>'
      echo 'void fragment(rlslab_filter* filter, double const* psi, double const* y, double* out) {'
      cat "$fragment"
      echo '(void)filter, (void)psi, (void)y, (void)out; }'; } >whole.c
    "$CC" -std=c99 -pedantic -Wall -Wextra -Werror "${flags[@]}" -fsyntax-only whole.c
  done
}
build_ctypes() {
  script example python3 "$tree/docs/examples/ctypes/main.py"
  script bits python3 "$tree/tests/doors/bits.py"
}
build_rust() {
  "$rustc" --edition 2021 -O -D warnings -L "$LD_LIBRARY_PATH" -o example "$tree/docs/examples/rust/main.rs"
  "$rustc" --edition 2021 -O -D warnings -L "$LD_LIBRARY_PATH" -o bits "$tree/tests/doors/bits.rs"
}
script() {    # script NAME COMMAND...
  printf '#!/bin/sh\nPYTHONDONTWRITEBYTECODE=1 exec' >"$1"
  printf ' "%s"' "${@:2}" >>"$1"
  printf ' "$@"\n' >>"$1"
  chmod +x "$1"
}
same() {    # same WHAT FILE FILE
  cmp -- "$2" "$3" || { diff -- "$2" "$3" | head -n 4 || true; echo "$1: other than C++'s"; exit 1; }
}

for language in "$@"; do
  declare -F "build_$language" >/dev/null || { echo "no door of $language: there are c, ctypes and rust"; exit 2; }
done
mkdir -p cpp/states
"$cpp" save cpp/states >cpp/bits.txt
(( $(wc -l <cpp/bits.txt) == 36 )) || { echo "18 variants in float and double were expected"; exit 1; }
for language in "$@"; do
  mkdir -p "$language/states"
  (
    cd -- "$language"
    build_"$language"
    ./example >printed.txt
    sed -n '/^```text$/,/^```$/p' "$tree/docs/examples/$language/README.md" | sed '/^```/d' >page.txt
    cmp printed.txt page.txt || { echo "$language: the example prints other than its page says"; exit 1; }
    ./bits save states >bits.txt
    same "$language" ../cpp/bits.txt bits.txt
  )
  for state in cpp/states/*; do
    cmp -- "$state" "$language/states/$(basename "$state")"
  done
  echo "$language: the example runs; 18 variants in float and double: the same hashes, the same states"
done
for reader in cpp "$@"; do
  program=$work/$reader/bits
  [[ $reader != cpp ]] || program=$cpp
  for writer in cpp "$@"; do
    (cd -- "$reader" && "$program" load "$work/$writer/states") >loaded.txt
    same "$reader from a state of $writer" cpp/bits.txt loaded.txt
  done
done
echo "states: each of cpp $* loads those of each, with the same hashes"
