#!/usr/bin/env bash
# A small mission leaves everything it promises, the same on one thread and on two.
set -eu
. "$(dirname "$0")/support.sh"
for threads in 1 2; do
  "$bin/drone_inspection" --scene house --robots 2 --seed 3 --threads $threads --out out$threads \
    --quiet >stdout$threads.txt
  for file in metrics.json reconstruction.ply error.ply trajectory_1.tum trajectory_2.tum map.sfm \
      report.html; do
    [ -s out$threads/$file ] || { echo "out$threads/$file is missing"; exit 1; }
  done
done
# All but what depends on the machine must be equal.
diff <(lasting out1) <(lasting out2)
cmp out1/reconstruction.ply out2/reconstruction.ply
cmp out1/map.sfm out2/map.sfm

awk -v c="$(value out1 surface_coverage)" -v h="$(value out1 collisions)" -v k="$(value out1 min_clearance_m)" \
  'BEGIN { if (c < 0.93 || h != 0 || k <= 0) { print "coverage", c, "collisions", h, "clearance", k; exit 1 } }'
"$bin/evaluate_reconstruction" out1/reconstruction.ply out2/reconstruction.ply --emax 0.05 \
  --out judged >judged.txt
[ -s judged/metrics.json ]

# Published figures stand beside missions of their own scene and settings alone.
published='Beside the published figures'
unpublished() { if grep -q "$published" "$1/report.html"; then echo "figures of another in $1"; exit 1; fi; }
unpublished out1
for preset in powerplant statue; do
  "$bin/drone_inspection" --scene statue --preset $preset --voxel 0.6 --image-width 32 --robots 1 \
    --start-clearance 3.8 \
    --max-time 1 --quiet --out $preset >statue.txt || [ $? = 3 ]
done
grep -q "$published" statue/report.html
unpublished powerplant

# The map that was left holds that surface.
"$bin/evaluate_reconstruction" out1/reconstruction.ply out1/map.sfm --emax 0.05 --out of_map >map.txt
grep -q '"surface_coverage": 1.0' of_map/metrics.json

# Anybody's mesh, with settings from a file.
printf 'robots = 2\nmax-time = 15\nrange = [1.0, 6.0]\nplanner = "tsga"\n' >settings.toml
status=0
"$bin/drone_inspection" --scene out1/reconstruction.ply --preset statue --config settings.toml \
  --start 6 6 2 --bounds -9 -9 1 9 9 8 --quiet --out mesh >mesh.txt || status=$?
[ $status = 3 ] || { echo "exit status $status, expected 3"; exit 1; }
grep -q '"planner": "tsga"' mesh/metrics.json
grep -q '"preset": "statue"' mesh/metrics.json
grep -q '"complete": false' mesh/metrics.json
unpublished mesh

# Drones that tell nothing keep apart by the lights that they see.
"$bin/drone_inspection" --scene house --robots 2 --seed 3 --neighbours markers --announcements off \
  --max-time 40 --quiet --out silent >silent.txt || [ $? = 3 ]
grep -q '"collisions": 0' silent/metrics.json

# A charge brings drones home, and the mission can be gone on with.
"$bin/drone_inspection" --scene house --robots 2 --seed 3 --endurance-m 12 --quiet --out charge >charge.txt
grep -q '"complete": false' charge/metrics.json
grep -q '"endurance"' charge/metrics.json
"$bin/drone_inspection" --scene house --robots 2 --seed 3 --continue charge --coverage-goal 0.5 --quiet \
  --out on >on.txt
grep -q '"stop_reason"' on/metrics.json

# A closed side is not entered, and the architecture is what it was asked to be.
"$bin/drone_inspection" --scene house --robots 1 --architecture centralized --seed 3 --quiet \
  --keep-out -20 3.5 0 20 20 20 --out closed >closed.txt
grep -q '"keep_out_violations": 0' closed/metrics.json
grep -q '"architecture": "centralized"' closed/metrics.json
awk '/^[^#]/ { if ($3 > 2.5) { print "entered: " $0; exit 1 } }' closed/trajectory_1.tum
awk '/judge_disagreement_m/ { n = 1; if ($2 + 0 > 1e-6) exit 1 } END { exit !n }' closed/metrics.json
