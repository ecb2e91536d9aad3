#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Whether systemd takes the units of deploy/systemd and finds them closed, and whether the program has every option
# that they and their configuration name. It starts no service.
# usage: systemd_test.sh TESSERA SOURCE_FOLDER; exits with 77 if it was skipped
set -euo pipefail
tessera=$1
source=$2/deploy/systemd

command -v systemd-analyze >/dev/null || { echo "skipped: systemd-analyze is not installed (apt-get install systemd)"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0
wrong() { echo "wrong: $*"; bad=1; }

for unit in tessera-coordinator tessera-worker; do
  kind=${unit#tessera-}
  sed "s|/usr/local/bin/tessera|$tessera|" "$source/$unit.service" >"$work/$unit.service"
  said=$(systemd-analyze verify "$work/$unit.service" 2>&1 | grep "$unit" || true)
  [ -z "$said" ] || wrong "systemd-analyze verify: $said"
  # 0 is closed, 10 is open; a service without any restriction has 9.6. In tenths.
  systemd-analyze security --offline=true --threshold=20 "$work/$unit.service" >"$work/security" ||
    wrong "$unit is open: $(tail -n 1 "$work/security")"
  tail -n 1 "$work/security"

  help=$("$tessera" "$kind" --help)
  command=$(sed -n 's/^ExecStart=//p' "$source/$unit.service")
  options=$(grep -oE -- '--[a-z-]+' <<<"$command")
  configured=$(sed -nE 's/^(# )?([a-z-]+) = .*/--\2/p' "$source/$kind.toml")
  if [ -z "$options" ] || [ -z "$configured" ]; then wrong "$unit names no options"; fi
  for option in $options $configured; do
    grep -qE -- "(^|[ ,])$option([ ,]|$)" <<<"$help" || wrong "$unit: tessera $kind has no $option"
  done

  grace=$(sed -nE 's/.*--grace ([0-9]+).*/\1/p' <<<"$command")
  stop=$(sed -nE 's/^TimeoutStopSec=([0-9]+)$/\1/p' "$source/$unit.service")
  [ "${grace:-0}" -lt "$stop" ] || wrong "$unit is killed before its grace of $grace s is over"
done
exit "$bad"
