#!/usr/bin/env bash
# Installs what is missing of the packages named on the command line (or of the set needed to build
# everything), says so, and is silent and quick when nothing is.
#   cmake/packages.sh [run|check|ci]
set -euo pipefail

run=(g++ cmake ninja-build libeigen3-dev libfcl-dev libccd-dev libembree-dev
     libpng-dev libzstd-dev cyclonedds-dev cyclonedds-tools openssl libcli11-dev nlohmann-json3-dev)
check=("${run[@]}" libbenchmark-dev liboctomap-dev libopencv-calib3d-dev libompl-dev libboost-serialization-dev
       libboost-filesystem-dev libboost-system-dev libboost-program-options-dev)
ci=("${check[@]}" clang-14 libclang-rt-14-dev clang-format-14 git)

case "${1:-check}" in
  run) wanted=("${run[@]}") ;;
  check) wanted=("${check[@]}") ;;
  ci) wanted=("${ci[@]}") ;;
  *) echo "packages.sh: unknown set '$1'; expected run, check or ci" >&2; exit 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  [ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" = "install ok installed" ] ||
    missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "installing: ${missing[*]}"
as_root=()
[ "$(id -u)" = 0 ] || as_root=(sudo)
command -v apt-get >/dev/null || {
  echo "packages.sh: this is no Debian or Ubuntu; install the packages above by other means" >&2
  exit 2
}
log=$(mktemp)
install() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y \
    --no-install-recommends "${missing[@]}" >"$log" 2>&1
}
# Without a fresh package list the first attempt may fail; with one it should not.
install || { "${as_root[@]}" apt-get update >>"$log" 2>&1 && install; } ||
  { tail -n 20 "$log" >&2; echo "packages.sh: apt-get could not install the packages" >&2; exit 1; }
rm -f "$log"
