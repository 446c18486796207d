#!/usr/bin/env bash
# A distributed fleet: equal maps in the end, the same on one thread and on two, through a network
# that parts it and with robots that are lost; and what is refused.
set -eu
. "$(dirname "$0")/support.sh"
fly() { "$bin/drone_inspection" --scene house --robots 3 --seed 3 --architecture distributed --quiet "$@"; }

for threads in 1 2; do
  fly --network poor --least-gain 0 --threads $threads --out poor$threads >poor.txt
done
diff <(lasting poor1) <(lasting poor2)
cmp poor1/map.sfm poor2/map.sfm
[ "$(value poor1 maps_equal)" = true ] && [ "$(value poor1 complete)" = true ]
[ "$(value poor1 collisions)" = 0 ] && [ "$(value poor1 architecture)" = '"distributed"' ]
[ "$(value poor1 loss)" -gt 0 ] || fail "nothing was lost on the way"
awk -v c="$(value poor1 surface_coverage)" 'BEGIN { exit !(c > 0.95) }'

printf 'latency = 0.05\nbandwidth = 1e7\npartition = ["5 to 25: 1 | 2 3"]\ncut = ["25 to 30: 2 > 1"]\n' >net.toml
printf 'killed = ["2 at 12"]\n' >events.toml
fly --least-gain 0 --network net.toml --events events.toml --wait-for-team 10 --out lost >lost.txt
grep -q '1 robots lost' lost.txt
[ "$(value lost maps_equal)" = true ] && [ "$(value lost complete)" = true ]
[ "$(value lost partition)" -gt 0 ] || fail "nothing was cut off"
awk -v c="$(value lost surface_coverage)" 'BEGIN { exit !(c > 0.95) }'

printf 'restarted = ["2 at 12"]\n' >events.toml
fly --events events.toml --out again >again.txt
[ "$(value again maps_equal)" = true ] || fail "a robot that began anew holds another map"
! grep -q '"ended"\|"lost"\|"stranded"' again/metrics.json || fail "not all came to an end: $(cat again/metrics.json)"
[ "$(value again took_s)" != null ] || fail "a robot that began anew did not catch up"

refuse() { refused drone_inspection --scene house --robots 3 "$@" --out out; }
refuse --architecture shared
refuse --network poor
refuse --architecture distributed --network nowhere
refuse --architecture distributed --announcements off
refuse --architecture distributed --coverage-goal 1.5
refuse --architecture distributed --patch-images 0
refuse --architecture distributed --patch-distance 0
refuse --patch-distance 2
refuse --architecture distributed --wait-for-team 0
for line in 'loss = 2' 'jitter = 1' 'losss = 0.1' 'partition = ["5: 1 | 2"]' 'partition = ["5 to 9: 1 | 4"]' \
    'cut = ["5 to 9: 1 > x"]' 'bandwidth = 0'; do
  echo "$line" >bad.toml
  refuse --architecture distributed --network bad.toml
done
for line in 'killed = ["4 at 12"]' 'killed = ["1"]' 'killed = ["1 at noon"]' 'killed = ["1 at 5 or 6"]' 'eaten = ["1 at 2"]'; do
  echo "$line" >bad.toml
  refuse --architecture distributed --events bad.toml
done
