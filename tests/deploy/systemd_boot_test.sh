#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The units of deploy/systemd under a systemd that is booted for them, in a container over this machine's files and
# without a network: both start as they are, closed; a picture is rendered with keys; the coordinator is killed and is
# started again; both end when they are told to. It takes no part in this machine's own services.
# usage: systemd_boot_test.sh TESSERA SOURCE_FOLDER; exits with 77 if it was skipped
set -euo pipefail
tessera=$1
source=$2

skip() { echo "skipped: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "only root may boot a container"
command -v systemd-nspawn >/dev/null || skip "systemd-nspawn is not installed (apt-get install systemd-container)"
[ -x /lib/systemd/systemd ] && [ -x /usr/bin/dbus-daemon ] || skip "there is no systemd to boot"
[ "$(stat -f -c %T /)" != overlayfs ] || skip "the root folder is an overlay itself"

work=$(mktemp -d /var/tmp/tessera-systemd.XXXXXX)
root=$work/root
mkdir -p "$work/upper" "$work/work" "$root"
stop() {
  umount "$root" 2>/dev/null || umount --lazy "$root" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap stop EXIT
mount -t overlay overlay -o "lowerdir=/,upperdir=$work/upper,workdir=$work/work" "$root" 2>/dev/null ||
  skip "no overlay can be mounted here"

install "$tessera" "$root/usr/local/bin/tessera"
install -D -m 644 "$source/deploy/systemd/sysusers.conf" "$root/usr/lib/sysusers.d/tessera.conf"
install -m 644 "$source"/deploy/systemd/tessera-*.service "$root/etc/systemd/system/"
mkdir -p "$root/etc/tessera" "$root/srv/tessera"
install -m 644 "$source"/deploy/systemd/*.toml "$root/etc/tessera/"
sed -i 's/farm.example/127.0.0.1/' "$root/etc/tessera/worker.toml"
install -m 644 "$source/scenes/cornell.json" "$root/srv/tessera/"

cat >"$root/srv/tessera/steps.sh" <<'STEPS'
set -euxo pipefail
finish() {
  local code=$?
  set +e
  [ "$code" -eq 0 ] || journalctl --unit=tessera-coordinator --unit=tessera-worker --no-pager
  kill -s RTMIN+14 1  # power off, at once
}
trap finish EXIT
until_true() {
  local end=$((SECONDS + 60))
  until "$@"; do [ "$SECONDS" -lt "$end" ] || return 1; sleep 0.2; done
}
state() { systemctl show --property="$2" --value "$1"; }
is() { [ "$(state "$1" "$2")" = "$3" ]; }

systemd-sysusers
cd /etc/tessera
for name in coordinator worker person; do tessera keygen -o "$name" >/dev/null; done
sed -n 's/^public-key/worker here/p' worker.pub >allow
sed -n 's/^public-key/submitter,administrator person/p' person.pub >>allow
chown tessera: coordinator.key worker.key allow

systemctl start tessera-coordinator tessera-worker
export TESSERA_COORDINATOR=127.0.0.1:7711 TESSERA_KEY=/etc/tessera/person.key TESSERA_SERVER_KEY=/etc/tessera/coordinator.pub
render() {
  tessera submit /srv/tessera/cornell.json --width 64 --height 64 --samples 16 --quiet -o "/srv/tessera/$1.exr" --timeout 60
  test -s "/srv/tessera/$1.exr"
}
render one
systemctl reload tessera-coordinator tessera-worker
is tessera-worker NRestarts 0
is tessera-coordinator NRestarts 0

kill -KILL "$(state tessera-coordinator MainPID)"
until_true is tessera-coordinator NRestarts 1
until_true is tessera-coordinator ActiveState active
render two
cmp /srv/tessera/one.png /srv/tessera/two.png
[ "$(tessera jobs --all | grep -c completed)" -eq 2 ]
is tessera-worker NRestarts 0

systemctl stop tessera-worker
is tessera-worker Result success
tessera workers | grep -q 'no workers'
systemctl stop tessera-coordinator
is tessera-coordinator Result success
find /var/lib/tessera -maxdepth 1 ! -user tessera | grep . && exit 1
echo "all is well"
STEPS
cat >"$root/etc/systemd/system/steps.service" <<'UNIT'
[Unit]
Wants=dbus.service
After=basic.target dbus.service
[Service]
Type=oneshot
ExecStart=/bin/bash /srv/tessera/steps.sh
StandardOutput=append:/srv/tessera/log
StandardError=append:/srv/tessera/log
UNIT
cat >"$root/etc/systemd/system/steps.target" <<'UNIT'
[Unit]
Requires=basic.target
Wants=steps.service
UNIT

name=tessera-$$
timeout 300 systemd-nspawn --quiet --register=no --keep-unit --private-network --directory="$root" --machine="$name" \
  --console=pipe --link-journal=no --boot systemd.unit=steps.target </dev/null >"$work/console" 2>&1 || true
if [ ! -s "$root/srv/tessera/log" ]; then
  cat "$work/console"
  skip "systemd does not boot in a container here"
fi
cat "$root/srv/tessera/log"
grep -q '^all is well$' "$root/srv/tessera/log"
