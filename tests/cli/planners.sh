#!/usr/bin/env bash
# Every planner that has a name flies, says why it leaves what it leaves, and flies the same on one
# thread and on two.
set -eu
. "$(dirname "$0")/support.sh"
for planner in surfleet tsga nnb tsga-plus nnb-plus makespan tours; do
  for threads in 1 2; do
    "$bin/drone_inspection" --scene house --robots 3 --planner $planner --threads $threads \
      --least-gain 0 --quiet --out $planner$threads >stdout.txt
  done
  diff <(lasting ${planner}1) <(lasting ${planner}2)
  grep -q '"complete": true' ${planner}1/metrics.json
  grep -q '"collisions": 0' ${planner}1/metrics.json
  # Standing still shows less than this.
  awk -v name=$planner '/"surface_coverage"/ { c = $2 + 0 } /"total_path_length_m"/ { l = $2 + 0 }
    END { if (c < 0.9 || l < 15) { print name, "covers", c, "and flies", l; exit 1 } }' \
    ${planner}1/metrics.json
  if grep -q not_attempted ${planner}1/metrics.json; then
    echo "$planner leaves elements without a reason"
    exit 1
  fi
done
# Clusters by path are another, and the settings of the seeds are heard.
"$bin/drone_inspection" --scene house --planner tsga --cluster-distance path --cluster-max-radius 3 \
  --merge-distance 0.5 --truncation 0.5 --disparity-error 0.05 --utility-share 0.5 --quiet \
  --out by_path >stdout.txt
grep -q '"complete": true' by_path/metrics.json

# Trials: one row for each planner and fleet, all missions in the file; those cut short are told of.
"$bin/drone_inspection_trials" --scene house --planners surfleet,nnb --fleets 1,2 --trials 2 --out trials \
  >table.txt 2>/dev/null
[ "$(grep -c '"planner"' trials/trials.json)" = 8 ]
[ "$(grep -c '2 of 2' table.txt)" = 4 ]
[ -s trials/report.html ]
status=0
"$bin/drone_inspection_trials" --scene house --planners tsga --fleets 2 --trials 2 --max-time 10 \
  --out cut >table.txt 2>/dev/null || status=$?
[ $status = 3 ] && grep -q '0 of 2' table.txt
