#!/usr/bin/env bash
# cost.sh TREE: for each filter its operations and bytes, and for each processor the instructions of one update and the
# bytes of code, counted by the emulator and the linker. The emulator takes 8 ns an instruction (-icount shift=3) and a
# tick of its 25 MHz clock 40: five instructions a tick. What the same program takes with Nothing in place of a filter
# is subtracted. Code is what is linked beyond that program; libgcc's and libm's part counts. Fewer instructions than
# operations are an error: the compiler removed a part of the update.
set -euo pipefail
tree=$(realpath -- "$1") work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
board=$tree/docs/examples/microcontroller/board
common=(-std=c++20 -ffp-contract=off -DNDEBUG -I "$tree/src" -isystem /usr/include/eigen3 -I "$board"
  "$tree/tests/embedded/cost.cpp")
measure() {    # measure MACHINE FLAGS...: text bytes, instructions of 1000 updates, bytes of the filter
  local machine=$1 ticks
  shift
  arm-none-eabi-g++ "${common[@]}" -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections \
    -fdata-sections -mthumb "$@" "$board/cortex_m.cpp" \
    --specs=nano.specs -nostartfiles -T "$board/mps2.ld" -Wl,--gc-sections -o "$work/app.elf"
  text=$(arm-none-eabi-size "$work/app.elf" | awk 'NR == 2 { print $1 }')
  { read -r ticks; read -r bytes; } < <(qemu-system-arm -M "$machine" -nographic -icount shift=3 \
    -semihosting-config enable=on,target=native -kernel "$work/app.elf" </dev/null 2>&1)
  instructions=$((5 * ticks))
}
declare -A bare loop
printf '| filter | option | operations | bytes | M3: instructions | code | M4F: instructions | code '
printf '| M7: instructions | code |\n|---|---|---|---|---|---|---|---|---|---|\n'
for filter in "Ud<float, 3>" "Ud<float, 5>" "Ud<float, 10>" "Ud<double, 5>" \
    "UdDelta<float, 3>" "UdDelta<float, 5>" "UdDelta<float, 10>" "UdDelta<double, 5>" \
    "Carlson<float, 5>" "CarlsonDelta<float, 5>" "InverseQr<float, 5>" "InverseQrDelta<float, 5>" \
    "Qr<float, 5>" "Conventional<float, 3>" "Conventional<float, 5>" "ByHand<float, 3>" "ByHand<float, 5>" \
    "Guarded<UdDelta<float, 3>>" "Guarded<UdDelta<float, 5>>" "Assessed<UdDelta<float, 5>>"; do
  size=${filter//[^0-9]/} word=$(grep -o 'float\|double' <<<"$filter")
  g++ "${common[@]}" -DCOUNTED "-DFILTER=${filter/$word/Counted<$word>}" -DPARAMETERS="$size" -lmpfr -lgmp \
    -o "$work/host"
  operations=$(($("$work/host" | head -1) / 1000))
  for option in -Os -O2 -O3; do
    [[ $option == -O2 || $filter == "Ud<float, 5>" ]] || continue
    row=""
    for machine in "mps2-an385 -mcpu=cortex-m3" "mps2-an386 -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16" \
        "mps2-an500 -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16"; do
      key=$machine$option$word$size
      if [[ ! -v bare[$key] ]]; then
        measure $machine $option "-DFILTER=Nothing<$word, $size>" -DPARAMETERS="$size"
        bare[$key]=$text loop[$key]=$instructions
      fi
      measure $machine $option "-DFILTER=$filter" -DPARAMETERS="$size"
      count=$(((instructions - loop[$key] + 500) / 1000))
      ((count >= operations)) || { echo "$filter: $count instructions for $operations operations" >&2 && exit 1; }
      row+=" $count | $((text - bare[$key])) |"
    done
    [[ $filter == ByHand* ]] && name="by hand, $size \`$word\`" || name="\`$filter\`"
    echo "| $name | \`$option\` | $operations | $bytes |$row"
  done
done
