#!/usr/bin/env bash
# Trials over many scenes leave one file a mission, and go on where they ended.
set -eu
. "$(dirname "$0")/support.sh"
trials() {
  "$bin/drone_inspection_trials" --scenes "$scenes" --planners surfleet --fleets 2 --trials 1 \
    --max-time 4 --threads 1 --out trials "$@" >table.txt 2>err.txt
}
scenes=random:shell:1-2,random:all:1006,house
status=0
trials || status=$?
[ $status = 3 ] || { echo "exit status $status, expected 3"; cat err.txt; exit 1; }  # all cut short
files="house_surfleet_r2_s1.json random-hall-1006_surfleet_r2_s1.json \
random-shell-1_surfleet_r2_s1.json random-shell-2_surfleet_r2_s1.json"
for file in $files; do
  [ -s trials/$file ] || { echo "$file is missing"; ls trials; exit 1; }
  for key in surface_coverage rmse_m collisions min_clearance_m total_path_length_m \
      completion_time_s library_version voxel_m max-time; do
    grep -q "\"$key\":" trials/$file || { echo "$file: no $key"; exit 1; }
  done
done
[ "$(ls trials/*.json | wc -l)" = 4 ]
grep -q '"seed_use": "reported"' trials/random-hall-1006_surfleet_r2_s1.json
grep -q '^development seeds: shell:1, shell:2$' table.txt
grep -q '^reported seeds: hall:1006$' table.txt
grep -q '^4 missions, 0 of them flown before$' table.txt
[ -s trials/report.html ]
cp table.txt first.txt

# What was half written counts for nothing and is flown again, and nothing else is.
good=trials/house_surfleet_r2_s1.json
cp $good whole.json
head -c 300 whole.json >$good
head -c 300 whole.json >trials/random-shell-1_surfleet_r2_s1.json.partial
for file in $files; do touch -d '2020-01-01' trials/$file; done
trials || true
grep -q '^4 missions, 3 of them flown before$' table.txt
strip() { grep -vE '"(wall_time_s|planning_time_s)"' "$1"; }
diff <(strip whole.json) <(strip $good)
[ "$(find trials -name '*_s1.json' -newermt 2021-01-01 | wc -l)" = 1 ]
# The table is of the files alone.
diff <(grep '^random:shell' first.txt) <(grep '^random:shell' table.txt)

# What is missing is flown.
rm trials/random-shell-2_surfleet_r2_s1.json trials/random-hall-1006_surfleet_r2_s1.json
trials || true
grep -q '^4 missions, 2 of them flown before$' table.txt
[ "$(ls trials/*_s1.json | wc -l)" = 4 ]

# Missions with other settings are not mixed up.
status=0
"$bin/drone_inspection_trials" --scenes house --planners surfleet --fleets 2 --trials 1 --max-time 5 \
  --out trials >stdout.txt 2>err.txt || status=$?
[ $status = 2 ] && [ "$(wc -l <err.txt)" = 1 ] && grep -q 'other settings' err.txt

# Ctrl-C: exit status 3, and no file of the mission that was under way.
"$bin/drone_inspection_trials" --scenes random:tower:2 --planners surfleet --fleets 1 --trials 1 \
  --threads 1 --out cut >cut.txt 2>cut_progress.txt &
pid=$!
for _ in $(seq 600); do
  grep -q ' m ' cut_progress.txt && break
  sleep 0.2
done
kill -INT $pid
status=0
wait $pid || status=$?
[ $status = 3 ] || { echo "exit status $status after an interrupt, expected 3"; exit 1; }
grep -q '^1 of 1 missions are missing$' cut.txt
[ -z "$(ls cut | grep json || true)" ]
