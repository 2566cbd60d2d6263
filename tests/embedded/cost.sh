#!/usr/bin/env bash
# cost.sh TREE: for each filter and processor the instructions of one update and the bytes of code, counted by the
# emulator and the linker. The emulator takes 8 ns an instruction (-icount shift=3) and a tick of its 25 MHz clock 40:
# five instructions a tick. What the same program takes without a filter is subtracted. Code is what is linked beyond
# that program; libgcc's and libm's part counts.
set -euo pipefail
tree=$(realpath -- "$1") work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
board=$tree/examples/microcontroller/board
measure() {    # measure MACHINE FLAGS...: text bytes and instructions of 1000 updates
  local machine=$1
  shift
  arm-none-eabi-g++ -std=c++20 -ffp-contract=off -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections \
    -fdata-sections -DNDEBUG -mthumb "$@" -I "$tree/src" -isystem /usr/include/eigen3 -I "$board" \
    "$tree/tests/embedded/cost.cpp" "$board/cortex_m.cpp" \
    --specs=nano.specs -nostartfiles -T "$board/mps2.ld" -Wl,--gc-sections -o "$work/app.elf"
  text=$(arm-none-eabi-size "$work/app.elf" | awk 'NR == 2 { print $1 }')
  instructions=$((5 * $(qemu-system-arm -M "$machine" -nographic -icount shift=3 \
    -semihosting-config enable=on,target=native \
    -kernel "$work/app.elf" </dev/null 2>&1)))
}
printf '| filter | option | M3: instructions | code | M4F: instructions | code | M7: instructions | code |\n'
printf '|---|---|---|---|---|---|---|---|\n'
for filter in "Ud<float, 3>" "Ud<float, 5>" "Ud<float, 10>" "Ud<double, 5>" \
    "UdDelta<float, 3>" "UdDelta<float, 5>" "UdDelta<float, 10>" "UdDelta<double, 5>" \
    "Carlson<float, 5>" "CarlsonDelta<float, 5>" "InverseQr<float, 5>" "InverseQrDelta<float, 5>" \
    "Qr<float, 5>" "Conventional<float, 5>"; do
  size=${filter//[^0-9]/}
  for option in -Os -O2 -O3; do
    [[ $option == -O2 || $filter =~ ^Ud(Delta)?"<float, 5>" ]] || continue
    row="| \`$filter\` | \`$option\` |"
    for machine in "mps2-an385 -mcpu=cortex-m3" "mps2-an386 -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16" \
        "mps2-an500 -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16"; do
      measure $machine $option
      bare=$text loop=$instructions
      measure $machine $option "-DFILTER=$filter" -DSIZE="$size"
      row+=" $(((instructions - loop + 500) / 1000)) | $((text - bare)) |"
    done
    echo "$row"
  done
done
