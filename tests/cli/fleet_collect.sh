#!/usr/bin/env bash
# What --collect makes of a team's folders, made up of two short flights: a robot that is missing, was killed, ended
# early or holds another map is named, and the exit status says so; a run of benchmarks/fleet_runs is good only then.
set -eu
benchmarks=$(cd "$(dirname "$0")/../../benchmarks" && pwd)
. "$(dirname "$0")/support.sh"
domain=$((1 + $$ % 200))
agent=("$bin/fleet_agent" --scene house --seed 3 --robots 3 --quiet)

# -- flights that end at their longest time --------------------------------------------------------
for id in 1 2; do
  status=0
  "${agent[@]}" --domain $domain --team "c$$" --join 0 --speed-up 20 --max-time $((4 * id)) --id $id \
    --out flown/$id >flown.txt || status=$?
  [ $status = 3 ] && [ "$(value flown/$id stop_reason)" = '"ended"' ] || fail "status $status: $(cat flown.txt)"
done
cmp -s flown/1/map.sfm flown/2/map.sfm && fail "two flights left the same map"

# -- three robots made of the first ----------------------------------------------------------------
# ended ROBOT REASON: its folder says so.
ended() {
  local complete=false
  [ "$2" != complete ] || complete=true
  sed -i "s/\"stop_reason\": .*/\"stop_reason\": \"$2\",/; s/\"complete\": .*/\"complete\": $complete,/" $1/metrics.json
}
make_team() {
  rm -rf 1 2 3
  for id in 1 2 3; do
    cp -r flown/1 $id
    sed -i "s/\"id\": .*/\"id\": $id,/" $id/agent.json $id/metrics.json
    ended $id complete
  done
}
# collect STATUS WORDS FOLDER...: the exit status of the judge, and what stands in its report.
collect() {
  local expected=$1 words=$2 status=0
  shift 2
  rm -rf team
  "${agent[@]}" --collect "$@" --out team >team.txt || status=$?
  [ $status = $expected ] && grep -q "$words" team.txt || fail "status $status, not $expected, or no '$words': $(cat team.txt)"
}
# list KEY: an array of the report on one line.
list() { tr -d ' \n' <team/metrics.json | grep -o "\"$1\":\[[^]]*\]" | sed 's/.*://'; }
# good STATUSES KILLED: whether fleet_runs counts that.
good() {
  python3 - "$benchmarks" "$1" "$2" <<'END'
import importlib.machinery, json, sys
sys.path.insert(0, sys.argv[1])
sys.dont_write_bytecode = True
runs = importlib.machinery.SourceFileLoader("fleet_runs", sys.argv[1] + "/fleet_runs").load_module()
statuses, killed = json.loads(sys.argv[2]), json.loads(sys.argv[3])
run = json.load(open("team/metrics.json")) | {"statuses": statuses, "judged": 0 if killed is None else 3}
sys.exit(0 if runs.is_good(run, 3, killed) else 1)
END
}

make_team
collect 0 '^complete: house, 3 of 3 robots, maps equal' 1 2 3
[ "$(value team complete)" = true ] && [ "$(value team maps_equal)" = true ] && [ "$(list missing_robots)" = '[]' ]
good '[0,0,0]' null || fail "a complete fleet does not count"
good '[0,3,0]' null && fail "a robot with another status counts"
ended 2 enough
collect 0 '^enough: ' 3 2 1
[ "$(value team complete)" = false ] && [ "$(value team ended_well)" = true ]
good '[0,0,0]' null && fail "what is not complete counts"

make_team
collect 3 'robot 2 is missing' 1 3
[ "$(value team complete)" = false ] && [ "$(list missing_robots)" = '[2]' ] || fail "$(cat team.txt)"
good '[0,0,0]' null && fail "a missing robot counts"

ended 2 ended
collect 3 'robot 2 ended early' 1 2 3
[ "$(value team complete)" = false ] && [ "$(value team maps_equal)" = true ]
good '[0,0,0]' null && fail "an incomplete robot counts"

rm 2/metrics.json
collect 3 'robot 2 was lost' 1 2 3
[ "$(value team complete)" = false ] && [ "$(list lost_robots)" = '[2]' ]
good '[0,-9,0]' null && fail "a killed robot counts"
good '[0,-9,0]' 2 || fail "a fleet that goes on without one does not count"
good '[0,-9,0]' 3 && fail "a fleet that loses another counts"

make_team
cp flown/2/map.sfm 2/map.sfm
collect 3 'maps not equal' 1 2 3
[ "$(value team maps_equal)" = false ] && [ "$(value team ended_well)" = false ]
good '[0,0,0]' null && fail "another map counts"
ended 2 ended # it holds another map, and is not left out for that
collect 3 'maps not equal' 1 2 3

make_team
sed -i 's/"patches_digest": .*/"patches_digest": "other",/' 3/metrics.json
collect 3 'maps not equal' 1 2 3
rm 3/map.sfm
collect 3 'maps not equal' 1 2 3

# -- the script that starts a fleet passes the worst status on -------------------------------------
status=0
"$bin/start_fleet" 2 --scene house --domain $domain --team "s$$" --join 0 --speed-up 20 --max-time 4 --quiet \
  --out fleet >fleet.txt || status=$?
[ $status = 3 ] && [ -e fleet/team/report.html ] && grep -q 'robot 2 ended early' fleet.txt || fail "status $status: $(cat fleet.txt)"
refused start_fleet 0
