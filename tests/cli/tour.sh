#!/usr/bin/env bash
# The tour of a structure that is known: what it leaves, that it is what it says, and how it ends.
set -eu
. "$(dirname "$0")/support.sh"

# A block of 4 x 4 x 3 m, 2 m above the ground of its coordinates.
printf 'v -2 -2 2\nv 2 -2 2\nv 2 2 2\nv -2 2 2\nv -2 -2 5\nv 2 -2 5\nv 2 2 5\nv -2 2 5\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n' >block.obj
for threads in 1 2; do
  "$bin/plan_coverage_tour" block.obj --coverage 0.9 --start 6 0 3 --floor none --threads $threads \
    --out block$threads >block.txt
done
for file in viewpoints.csv tour.json tour.tum reconstruction.ply metrics.json report.html; do
  [ -s block1/$file ] || { echo "block1/$file is missing"; exit 1; }
done
for file in viewpoints.csv tour.json tour.tum reconstruction.ply; do
  cmp block1/$file block2/$file
done
awk -v c="$(value block1 surface_coverage)" -v h="$(value block1 collisions)" \
  -v l="$(value block1 total_path_length_m)" \
  'BEGIN { if (c < 0.9 || h != 0 || l < 10 || l > 120) { print "coverage", c, "hits", h, "length", l; exit 1 } }'
# The start, then as many viewpoints as there are said to be, each where the tour passes by.
[ "$(head -n 1 block1/viewpoints.csv)" = index,x_m,y_m,z_m,yaw_rad ]
[ "$(($(wc -l <block1/viewpoints.csv) - 1))" = "$(value block1 viewpoints)" ]
sed -n 2p block1/tour.tum | grep -qE '^0(\.0)? 6 0 3 '
tail -n +2 block1/viewpoints.csv | while IFS=, read -r _ x y z _; do
  awk -v x="$x" -v y="$y" -v z="$z" \
    '$2 == x + 0 && $3 == y + 0 && $4 == z + 0 { found = 1 } END { exit !found }' block1/tour.tum ||
    { echo "the tour misses $x $y $z"; exit 1; }
done
# What it says of its images, another program says too, of the parts that can be seen.
"$bin/evaluate_reconstruction" block.obj block1/reconstruction.ply --emax 0.2598 >judged.txt
awk -v own="$(value block1 surface_coverage)" \
  '/"surface_coverage"/ { if ($2 + 0 > own + 0.02 || $2 + 0 < 0.7 * own) { print; exit 1 } }' judged.txt

# Who asks for more than can be had gets what there is, and is told.
status=0
"$bin/plan_coverage_tour" --scene house --coverage 1.0 --spacing 3 --range 1.6 4 --out house \
  >house.txt || status=$?
[ $status = 3 ] && grep -q 'less than asked for' house.txt && [ -s house/report.html ]
"$bin/plan_coverage_tour" --help >help.txt
grep -q -- --coverage help.txt && grep -q -- --standoff help.txt
if grep -q -- --planner help.txt; then echo "a tour has no planner"; exit 1; fi
