#!/usr/bin/env bash
# Robots as processes of their own: equal maps in the end, also when one is killed and started again; keys; what is
# refused.
set -eu
. "$(dirname "$0")/support.sh"
domain=$((1 + $$ % 200))
common=(--scene house --seed 3 --wait-for-team 400 --quiet)
agent=("$bin/fleet_agent" "${common[@]}" --robots 2 --domain "$domain" --team "t$$")

# -- what is refused --------------------------------------------------------------------------------
refuse_any() { refused fleet_agent "${common[@]}" --out out "$@"; }
refuse() { refuse_any --robots 2 --domain $domain --team "t$$" "$@"; }
refuse
refuse --id 0
refuse --id 3
refuse_any --id 1 --team 'a/b' --domain $domain
refuse_any --id 1 --domain 999
refuse --id 1 --peers 'not a host'
refuse --id 1 --speed-up 0
refuse --id 1 --architecture single
refuse --id 1 --security nowhere
refuse --id 1 --network nowhere
for line in 'loss = 2' 'losss = 0.1' 'partition = ["5 to 9: 1 | 3"]'; do
  echo "$line" >bad.toml
  refuse --id 1 --network bad.toml
done
refuse --id 1 --patch-images 0
refuse --id 1 --patch-distance 0
refuse --collect nowhere
refuse --id 1 --stay -1
refused fleet_agent "${common[@]}" --domain $domain --id 1 --join 0 --out /proc/out
echo mine >taken
refused fleet_agent "${common[@]}" --domain $domain --id 1 --join 0 --out taken/1
[ "$(cat taken)" = mine ]
# Where there is no room, or none any more: one line, and no file is there by half.
mkdir full
if mount -t tmpfs -o size=64k none full 2>/dev/null; then
  trap 'umount full; rm -rf "$work"' EXIT
  refused fleet_agent "${common[@]}" --domain $domain --id 1 --join 0 --out full/1
  grep -q 'of room' stderr.txt && [ -z "$(ls full)" ] || fail "left in a full folder: $(ls full)"
  mount -o remount,size=20m full
  "${agent[@]}" --join 0 --speed-up 2 --id 1 --out full/1 >full.txt 2>stderr.txt &
  one=$!
  until_true 120 lines full/1/trajectory.tum 20 || fail "it does not fly"
  dd if=/dev/zero of=full/filler bs=64k >dd.txt 2>&1 || true
  status=0
  wait $one || status=$?
  [ $status = 2 ] && [ ! -s full.txt ] && [ "$(wc -l <stderr.txt)" = 1 ] && grep -q 'with room' stderr.txt ||
    fail "status $status in a folder that is full: $(cat stderr.txt)"
  [ "$(ls full/1)" = "$(printf 'agent.json\ntrajectory.tum')" ] || fail "left by half: $(ls full/1)"
  umount full
  trap 'rm -rf "$work"' EXIT
fi

# -- keys: a robot with none, wrong ones or expired ones is not of the team -------------------------
"$bin/make_fleet_keys" keys "t$$" 2
"$bin/make_fleet_keys" old "t$$" 2 -1
refuse --id 1 --join 0 --security old
grep -q expired stderr.txt || fail "$(cat stderr.txt)"
"$bin/make_fleet_keys" others "t$$" 2
cp -r keys foreign
cp -r keys/robot_2/. foreign/robot_1 # one robot's keys do not speak for another
refuse --id 1 --join 0 --security foreign

# -- two robots with keys, one of which is killed and started again ---------------------------------
"${agent[@]}" --speed-up 3 --join 60 --security keys --id 1 --out 1 >1.txt &
one=$!
"${agent[@]}" --speed-up 3 --join 60 --security keys --id 2 --out 2 >2.txt &
two=$!
trap 'kill -9 $(jobs -pr) 2>/dev/null || true; rm -rf "$work"' EXIT
until_true 120 lines 1/trajectory.tum 20 && until_true 120 lines 2/trajectory.tum 20 || fail "they do not fly"
# While they fly: with others they would not.
refuse --join 60 --security keys --id 1
grep -q 'alive elsewhere' stderr.txt || fail "$(cat stderr.txt)"
# Keys of other authorities: neither hears, nor is heard.
status=0
"${agent[@]}" --join 1 --max-time 4 --speed-up 4 --security others --id 1 --out other >other.txt || status=$?
[ $status = 3 ] && [ "$(value other found_team_s)" = null ] || fail "status $status: $(cat other.txt)"
kill -9 $two
wait $two 2>/dev/null || true
[ ! -e 2/metrics.json ] && [ -e 2/agent.json ]
"${agent[@]}" --speed-up 3 --join 60 --security keys --id 2 --out 2 >2.txt &
two=$!
wait $one || fail "robot 1: $(cat 1.txt)"
wait $two || fail "robot 2: $(cat 2.txt)"
[ -e 2/trajectory_before_1.tum ]
"${agent[@]}" --collect 1 2 --out team >team.txt || fail "$(cat team.txt)"
[ "$(value team complete)" = true ] && [ "$(value team maps_equal)" = true ] || fail "$(cat team.txt)"
[ "$(value team collisions)" = 0 ] || fail "$(cat team.txt; grep -hE "late_steps|min_(clearance|separation)" team/metrics.json 1/metrics.json 2/metrics.json)"
[ "$(value 1 found_team_s)" != null ] || fail "robots with keys do not find each other"
[ "$(value 1 patches_digest)" = "$(value 2 patches_digest)" ]
[ "$(value 1 secured)" = true ] && [ "$(value 1 other_partition)" = 0 ] && [ "$(value 1 bytes_sent)" -gt 0 ]
awk -v c="$(value team surface_coverage)" 'BEGIN { exit !(c > 0.95) }'
[ -s team/report.html ] && [ -s 1/reconstruction.ply ]

# -- one that stays away is named, and one that is ended writes what it has ------------------------
"$bin/fleet_agent" "${common[@]}" --robots 3 --domain $domain --id 3 --join 0 --out 3 >3.txt &
two=$!
until_true 120 lines 3/trajectory.tum 5 || fail "it does not fly"
# differs WORDS ROBOTS OPTIONS...: robot 1 of so many is refused for what these words say, while robot 3 flies.
differs() {
  local words=$1 robots=$2
  shift 2
  refused fleet_agent --robots $robots --domain $domain --id 1 --join 60 --out out "${common[@]}" "$@"
  grep -q "robot 3 of team surfleet $words" stderr.txt || fail "not for '$words': $(cat stderr.txt)"
}
differs 'has voxels of 0.3' 3 --voxel 0.25
differs 'has a truncation of' 3 --truncation 1.2
differs 'has a known weight of 0.3' 3 --known-weight 0.5
differs 'has images that weigh' 3 --weight constant
differs 'has a team of 3' 2
differs 'flies here' 3 --team other
kill -0 $two || fail "refusals have ended it: $(cat 3.txt)"
kill -TERM $two
status=0
wait $two || status=$?
[ $status = 3 ] && [ "$(value 3 stop_reason)" = '"ended"' ] && [ -e 3/map.sfm ] || fail "status $status: $(cat 3.txt)"
# Folders of different missions are not put together.
refuse_any --robots 2 --collect 1 3
grep -q 'another team' stderr.txt || fail "$(cat stderr.txt)"
refuse_any --robots 3 --collect 1 2
grep -q 'flown with robots 2' stderr.txt || fail "$(cat stderr.txt)"
refuse --voxel 0.25 --collect 1 2
grep -q 'flown with voxel_m 0.3' stderr.txt || fail "$(cat stderr.txt)"

# -- what was spent before a robot is started anew is spent ------------------------------------------
charge=("$bin/fleet_agent" "${common[@]}" --robots 1 --domain $domain --id 1 --join 0 --speed-up 8 --endurance-m 30 --out charge)
"${charge[@]}" >charge.txt &
one=$!
until_true 120 lines charge/trajectory.tum 180 || fail "it does not fly"
kill -9 $one
wait $one 2>/dev/null || true
"${charge[@]}" >charge.txt || fail "$(cat charge.txt)"
[ "$(value charge stop_reason)" = '"endurance"' ] || fail "$(cat charge.txt)"
awk -v before="$(value charge spent_before_m)" -v path="$(value charge path_length_m)" \
  'BEGIN { exit !(before > 5 && path > 0 && before + path <= 30) }' || fail "$(cat charge/metrics.json)"
# One that came to an end starts with a new charge.
"${charge[@]}" --max-time 2 >charge.txt || true
[ "$(value charge spent_before_m)" = 0.0 ] || fail "a mission of its own has spent $(value charge spent_before_m) m"
