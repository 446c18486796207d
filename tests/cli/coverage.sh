#!/usr/bin/env bash
# The coverage binaries and the tour solver do their default job and say so.
set -eu
. "$(dirname "$0")/support.sh"

"$bin/planar_coverage" --out plane >plane.txt 2>plane.err
[ -s plane/metrics.json ] && [ -s plane/report.html ] && [ -s plane/picture.svg ]
printf 'robots = 3\nseed = 5\n' >three.toml
"$bin/planar_coverage" --config three.toml --out three >three.txt 2>three.err
[ "$(value three robots)" = 3 ]
"$bin/planar_coverage" --mode geodesic --robots 3 --out geodesic >geodesic.txt 2>geodesic.err ||
  fail "$(cat geodesic.err)"
"$bin/surface_coverage" --robots 5 --out surface >surface.txt 2>surface.err
[ -s surface/metrics.json ] && [ -s surface/report.html ] && [ -s surface/regions.ply ]
awk -v s="$(value surface swept_fraction)" -v c="$(value surface final_cost)" \
  -v i="$(value surface initial_cost)" \
  'BEGIN { if (s < 1 || c > i) { print "swept", s, "cost", i, "to", c; exit 1 } }'
[ "$(value surface regions_connected)" = true ]

"$bin/surface_navigation" --quiet --out drive >drive.txt
[ -s drive/path.tum ] && [ -s drive/driven.tum ] && [ -s drive/strip.ply ] && [ -s drive/report.html ]
[ "$(value drive reached_goal)" = true ] && [ "$(value drive left_strip)" = 0 ]
awk -v r="$(value drive driven_ratio)" 'BEGIN { exit !(r > 0.98 && r < 1.1) }'
# A mesh made of scans is driven on like any other, and says how near it is to what was scanned.
"$bin/surface_navigation" --quiet --scene tube --scan-from -0.4 0 0 0.4 0 0 --cloud-noise 0.005 \
  --reconstruct mls --spacing 0.03 --faces 1500 --out scanned >scanned.txt
[ "$(value scanned reached_goal)" = true ] && [ "$(value scanned nonmanifold_edges)" = 0 ]
awk -v e="$(value scanned reconstruction_error_mean_m)" 'BEGIN { exit !(e > 0 && e < 0.01) }'
refused surface_navigation --scene tube --reconstruct mls --out out
refused surface_navigation --scene tube --reconstruct itm --scan-from -0.4 0 0 0.4 0 0 --out out
refused surface_navigation --scene tube --method dense --faces 100 --out out
# Every piece once; and blocked triangles that come in sight under way.
"$bin/surface_navigation" --quiet --cover --cover-by single --edge 0.2 --out once >once.txt
[ "$(value once covered_triangles)" = 1.0 ] && [ "$(value once left_strip)" = 0 ]
seq 100 7 600 >some.txt
"$bin/surface_navigation" --quiet --blocked some.txt --sense 0.3 --out seen >seen.txt
[ "$(value seen reached_goal)" = true ] && [ "$(value seen replans)" -gt 0 ]
# A wall of blocked triangles about the start is said to be one.
printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n' >two.ply
echo 1 >walls.txt
status=0
"$bin/surface_navigation" --quiet --scene two.ply --start 0.9 0.1 0 --goal 0.1 0.9 0 \
  --blocked walls.txt --out wall >wall.txt || status=$?
[ "$status" = 3 ] && grep -q 'blocked' wall/metrics.json

printf 'NAME: five\nTYPE: TSP\nDIMENSION: 5\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 0 3\n3 4 3\n4 4 0\n5 2 0\nEOF\n' >five.tsp
"$bin/solve_tour" five.tsp >tour.txt
grep -qE '^length +14$' tour.txt
# A shorter open path, a longer tour, and never a bound on the wrong side.
figure() { awk -v key="$1" '$1 == key { print $2 }' "$2"; }
"$bin/solve_tour" five.tsp --open --start 2 --time-limit 0.1 >open.txt
"$bin/solve_tour" five.tsp --maximize --time-limit 0.1 >most.txt
printf 'NAME: ring\nTYPE: ATSP\nDIMENSION: 4\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n0 1 9 9\n9 0 1 9\n9 9 0 1\n1 9 9 0\nEOF\n' >ring.atsp
"$bin/solve_tour" ring.atsp --iterations 50 >ring.txt
awk -v tour="$(figure length tour.txt)" -v bound="$(figure bound tour.txt)" \
  -v path="$(figure length open.txt)" -v most="$(figure length most.txt)" \
  -v most_bound="$(figure bound most.txt)" -v ring="$(figure length ring.txt)" \
  'BEGIN { if (bound > tour || path >= tour || most <= tour || most_bound < most || ring != 4) exit 1 }'
awk '$1 == "tour" { exit $2 != 2 }' open.txt
