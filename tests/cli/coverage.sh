#!/usr/bin/env bash
# The coverage binaries and the tour solver do their default job and say so.
set -eu
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
value() { grep "\"$2\":" "$1/metrics.json" | sed 's/.*: //; s/,.*//'; }

"$bin/planar_coverage" --out plane >plane.txt 2>plane.err
[ -s plane/metrics.json ] && [ -s plane/report.html ] && [ -s plane/picture.svg ]
"$bin/surface_coverage" --robots 5 --out surface >surface.txt 2>surface.err
[ -s surface/metrics.json ] && [ -s surface/report.html ] && [ -s surface/regions.ply ]
awk -v s="$(value surface swept_fraction)" -v c="$(value surface final_cost)" \
  -v i="$(value surface initial_cost)" \
  'BEGIN { if (s < 1 || c > i) { print "swept", s, "cost", i, "to", c; exit 1 } }'
[ "$(value surface regions_connected)" = true ]

printf 'NAME: five\nTYPE: TSP\nDIMENSION: 5\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 0 3\n3 4 3\n4 4 0\n5 2 0\nEOF\n' >five.tsp
"$bin/solve_tour" five.tsp >tour.txt
grep -q 14 tour.txt
