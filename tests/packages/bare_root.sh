#!/usr/bin/env bash
# bare_root.sh DEBS TREE: what `./lab package --bare-root` runs, as root, with mmdebstrap. Makes a bare Debian 12 (what
# apt needs, and an application's compilers), installs the packages there, and builds and runs what users would. The
# root is thrown away.
set -euo pipefail
debs=$(realpath -- "$1") tree=$(realpath -- "$2")
given=$(mktemp -d)
trap 'rm -rf -- "$given"' EXIT
cp "$debs"/*.deb "$given"
cp -r "$tree/tests/consumer" "$given/consumer"
cp -r "$tree/docs/examples" "$given/examples"
cp "$tree/studies/data/sales.csv" "$given"
cat >"$given/try.sh" <<'END'
set -eux
cd /given
export DEBIAN_FRONTEND=noninteractive
apt-get install -y --no-install-recommends ./librlslab1_*.deb ./librlslab-dev_*.deb
for compiler in g++ clang++; do
  for instructions in "" -march=native; do
    $compiler -O2 $instructions consumer/main.cpp $(pkg-config --cflags --libs rlslab) -o app
    ./app
    $compiler -O2 $instructions consumer/native.cpp $(pkg-config --cflags --libs rlslab-native) -o app
    ./app
  done
  for example in examples/*/CMakeLists.txt; do
    example=${example%/*}
    case $example in *own_study | *own_bench) continue ;; esac # below, with what the core needs
    cmake -G Ninja -S $example -B built -DCMAKE_CXX_COMPILER=$compiler -DCMAKE_BUILD_TYPE=Release
    cmake --build built
    (cd built && ctest --output-on-failure --no-tests=error)
    rm -rf built
  done
done
apt-get install -y --no-install-recommends ./rlslab_*.deb
rlslab --version
rlslab compare sales.csv --input lead --output sales --order 2 --detrend --no-timings | head -n 3
cc examples/c/main.c $(pkg-config --cflags --libs rlslab-c) -o from_c
./from_c
apt-get install -y ./librlslab-dev_*.deb libboost-dev libflint-arb-dev libflint-dev libmpfr-dev libgmp-dev libfmt-dev \
  libtbb-dev libbenchmark-dev ./rlslab-bench_*.deb
g++ -g0 consumer/owning.cpp $(pkg-config --cflags --libs rlslab-core) -o with_core
./with_core
cmake -G Ninja -S consumer -B built -DCMAKE_BUILD_TYPE=Debug
cmake --build built --target with_headers with_core with_native with_catalogue
built/with_headers
built/with_core
built/with_native
built/with_catalogue
for example in own_study own_bench; do
  cmake -G Ninja -S examples/$example -B $example
  cmake --build $example
done
(cd own_study && ctest --output-on-failure --no-tests=error)
own_bench/own_bench --sizes 5 --benchmark_filter=textbook
if ls ./python3-rlslab_*.deb; then
  apt-get install -y --no-install-recommends ./python3-rlslab_*.deb
  python3 -c 'import rlslab; assert rlslab.Ud(2).update([1.0, 2.0], 5.0).health == "sound"'
  apt-get purge -y python3-rlslab
fi
apt-get purge -y rlslab rlslab-bench librlslab-dev librlslab1
test -z "$(find / -xdev -name '*rlslab*' \
  -not -path '/given/*' -not -path '/proc/*' -not -path '/var/lib/apt/*' -not -path '/var/log/*' -print -quit)"
END
mmdebstrap --variant=apt --include=g++,clang,cmake,ninja-build,pkg-config --format=null \
  --customize-hook="copy-in $given /" --customize-hook="mv \"\$1/$(basename "$given")\" \"\$1/given\"" \
  --customize-hook='chroot "$1" sh /given/try.sh' bookworm /dev/null
