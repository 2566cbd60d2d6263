#!/usr/bin/env bash
# exported_cost.sh TREE PROGRAM: instructions of a row and bytes of the function that takes it: `ud` with 4 parameters
# in float, as `PROGRAM export c` writes it, with loops and without, beside by_hand.h. Counted as in cost.sh;
# a row that does nothing is subtracted. Rows are taken by a function of its own in C, whose step another file may read.
set -euo pipefail
tree=$(realpath -- "$1") program=$2 work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
board=$tree/docs/examples/microcontroller/board here=$tree/tests/embedded
export="$program export c --variant ud --size 4 --arithmetic float --name ud4"
$export >"$work/ud4.h"
$export --unrolled >"$work/ud4_unrolled.h"
declared='void unit_begin(void); void unit_row(const float *psi, float y);'
cat >"$work/nothing.c" <<<"$declared
void unit_begin(void) {}
void unit_row(const float *psi, float y) { (void)psi; (void)y; }"
cat >"$work/hand.c" <<<"#include \"$here/by_hand.h\"
$declared static by_hand f; float innovation;
void unit_begin(void) { by_hand_init(&f, 0.984375f, 1024.0f); }
void unit_row(const float *psi, float y) { innovation = by_hand_update(&f, psi, y); }"
for unit in ud4 ud4_unrolled; do
  cat >"$work/$unit.c" <<<"#include \"$unit.h\"
$declared static ud4 f; ud4_step step;
void unit_begin(void) { (void)ud4_init(&f, 0.984375f, 1024.0f); }
void unit_row(const float *psi, float y) { step = ud4_update(&f, psi, y); }"
done
measure() {    # measure UNIT OPTION MACHINE FLAGS...: bytes of unit_row, instructions of 1000 rows
  local unit=$1 option=$2 machine=$3 ticks
  shift 3
  arm-none-eabi-gcc -std=c99 -ffp-contract=off -mthumb "$option" "$@" -I "$work" -ffunction-sections \
    -c "$work/$unit.c" -o "$work/unit.o"
  bytes=$((16#$(arm-none-eabi-nm -S "$work/unit.o" | awk '/ unit_row$/ { print $2 }')))
  arm-none-eabi-g++ -std=c++20 -O2 -ffp-contract=off -fno-exceptions -fno-rtti -fno-threadsafe-statics \
    -ffunction-sections -fdata-sections -mthumb "$@" -I "$board" "$here/exported_cost.cpp" "$board/cortex_m.cpp" \
    "$work/unit.o" --specs=nano.specs -nostartfiles -T "$board/mps2.ld" -Wl,--gc-sections -o "$work/app.elf"
  ticks=$(qemu-system-arm -M "$machine" -nographic -icount shift=3 -semihosting-config enable=on,target=native \
    -kernel "$work/app.elf" </dev/null 2>&1)
  instructions=$((5 * ticks))
}
echo '| processor | option | by hand: instructions | bytes | exported: instructions | bytes | ratios | unrolled: '\
'instructions | bytes | ratios |'
echo '|---|---|---|---|---|---|---|---|---|---|'
while read -r name machine options; do
  read -ra flags <<<"$options"
  for option in -Os -O2 -O3; do
    measure nothing "$option" "$machine" "${flags[@]}"
    empty=$instructions
    row="| $name | \`$option\` |"
    for unit in hand ud4 ud4_unrolled; do
      measure "$unit" "$option" "$machine" "${flags[@]}"
      count=$(((instructions - empty + 500) / 1000))
      row+=" $count | $bytes |"
      if [[ $unit == hand ]]; then
        hand=$count hand_bytes=$bytes
      else
        row+=$(awk "BEGIN { printf \" %.2f, %.2f |\", $count / $hand, $bytes / $hand_bytes }")
      fi
    done
    echo "$row"
  done
done <<<"M3 mps2-an385 -mcpu=cortex-m3
M4F mps2-an386 -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16
M7 mps2-an500 -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16"
