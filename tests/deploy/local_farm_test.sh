#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What `./run farm` runs: it ends with an image, and neither then nor when it is stopped before leaves anything behind.
# usage: local_farm_test.sh TESSERA SOURCE_FOLDER; the program is in cli/ of the build's folder
set -euo pipefail
tessera=$1
source=$2
build=$(dirname "$(dirname "$tessera")")

work=$(mktemp -d /tmp/tessera-local.XXXXXX)
trap 'rm -rf "$work"' EXIT
export TMPDIR=$work OUT=$work/out
fail() { echo "failed: $*" >&2; tail -n 20 "$OUT"/*.log >&2; exit 1; }
nothing_is_left() {
  local left
  left=$(pgrep --full --list-full "$work/" || true)
  [ -z "$left" ] || fail "still there: $left"
  [ -z "$(find "$work" -maxdepth 1 -name 'tessera-farm.*')" ] || fail "its folder is still there"
}

code=0
bash "$source/scenes/farm.sh" "$build" --width 64 --height 36 --samples 16 || code=$?
[ "$code" -eq 0 ] || [ "$code" -eq 8 ] || fail "ends with $code"
[ "$(head -c 4 "$OUT/farm.exr" | od -An -tx1 | tr -d ' ')" = 762f3101 ] || fail "there is no image"
nothing_is_left

bash "$source/scenes/farm.sh" "$build" --samples 1048576 &
script=$!
job_is_under_way() {
  local socket
  socket=$(find "$work" -name socket)
  [ -n "$socket" ] && "$tessera" jobs --coordinator "ipc://$socket" | grep -q active
}
end=$((SECONDS + 120))
until job_is_under_way; do
  [ "$SECONDS" -lt "$end" ] || fail "the job does not begin"
  sleep 0.2
done
kill -TERM "$script"
code=0
wait "$script" || code=$?
[ "$code" -eq 130 ] || fail "stopped, it ends with $code"
nothing_is_left
