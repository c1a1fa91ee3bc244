#!/usr/bin/env bash
# Installs the field alone and builds examples/use_field with nothing but that.
#   tests/field_package.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --component lefort_field --prefix "$folder/prefix" >/dev/null
cmake -S "$source/examples/use_field" -B "$folder/build" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$folder/prefix" >/dev/null
cmake --build "$folder/build" >/dev/null
"$folder/build/use_field"
