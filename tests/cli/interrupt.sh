#!/usr/bin/env bash
# Ctrl-C leaves what was reconstructed so far, readable, and exit status 3.
set -eu
. "$(dirname "$0")/support.sh"
"$bin/drone_inspection" --scene powerplant --robots 2 --out out 2>progress.txt >stdout.txt &
pid=$!
for _ in $(seq 600); do
  grep -q ' m ' progress.txt && break
  sleep 0.2
done
sleep 2
kill -INT $pid
status=0
wait $pid || status=$?
[ $status = 3 ] || { echo "exit status $status, expected 3"; cat progress.txt; exit 1; }
[ -s out/reconstruction.ply ] && [ -s out/metrics.json ] && [ -s out/report.html ]
grep -q '"complete": false' out/metrics.json
"$bin/evaluate_reconstruction" out/reconstruction.ply out/reconstruction.ply --emax 0.26 --out judged \
  >judged.txt
