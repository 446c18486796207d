#!/usr/bin/env bash
# Paths over raw point clouds: what they leave, twice the same, and what is refused.
set -eu
. "$(dirname "$0")/support.sh"
for run in one two; do
  "$bin/surface_navigation" --scene tube --method dense --voxel 0.05 --out $run >/dev/null 2>&1
  for file in metrics.json tokens.ply edges.ply path.tum report.html; do
    [ -s $run/$file ] || { echo "$run/$file is missing"; exit 1; }
  done
done
cmp one/path.tum two/path.tum
cmp one/tokens.ply two/tokens.ply
grep -q '"reached_goal": true' one/metrics.json
awk -v r="$(value one geodesic_ratio)" -v o="$(value one orientation_error_deg)" \
  'BEGIN { if (r < 0.95 || r > 1.1 || o > 4) { print "ratio", r, "orientation", o; exit 1 } }'

# A cloud from a file, the one that was made.
"$bin/surface_navigation" --scene one/tokens.ply --method dense --voxel 0.05 --out cloud >cloud.txt 2>&1 ||
  [ $? = 3 ]
[ -s cloud/metrics.json ]

refused surface_navigation --scene tube --method magic --out out
refused surface_navigation --scene tube --method dense --voxel -1 --out out
refused surface_navigation --scene tube --method dense --robot epuck --out out
refused surface_navigation --scene nowhere.ply --method dense --out out
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >one.ply
refused surface_navigation --scene one.ply --method dense --out out
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\nnan 0 0\n1 0 0\n' >nan.ply
refused surface_navigation --scene nan.ply --method dense --out out
# A tree over the points, and motions on quadrics along it.
"$bin/surface_navigation" --scene tube --method sparse --cloud-noise 0.003 --quiet --out tree >tree.txt
[ "$(value tree reached_goal)" = true ] && [ -s tree/driven.tum ] && [ -s tree/report.html ]
awk -v r="$(value tree geodesic_ratio)" 'BEGIN { exit !(r > 0.9 && r < 1.12) }'
refused surface_navigation --scene tube --method sparse --goal 0 0 9 --out out
