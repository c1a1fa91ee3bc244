#!/usr/bin/env bash
# Installs all layers and builds examples/use_lefort with nothing but that.
#   tests/lefort_package.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for component in lefort_field lefort_dev; do
  cmake --install "$build" --component "$component" --prefix "$folder/prefix" >/dev/null
done
cmake -S "$source/examples/use_lefort" -B "$folder/build" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$folder/prefix" >/dev/null
cmake --build "$folder/build" >/dev/null
"$folder/build/use_lefort" "$source/examples/solve/stretch.json" "$folder/stretch"
test -s "$folder/stretch/solve.json"
