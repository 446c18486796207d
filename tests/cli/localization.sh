#!/usr/bin/env bash
# Relative localisation: what it leaves of simulated and recorded images, and what it refuses.
set -eu
. "$(dirname "$0")/support.sh"

"$bin/relative_localization" --frames 60 --out one >/dev/null 2>&1
"$bin/relative_localization" --frames 60 --out two >/dev/null 2>&1
for file in pose.tum detections.csv covariance.csv metrics.json report.html; do
  [ -s one/$file ] || { echo "one/$file is missing"; exit 1; }
done
for file in pose.tum detections.csv covariance.csv; do cmp one/$file two/$file; done
ls one/overlay_*.png >/dev/null
[ "$(value one frames)" = 60 ] && [ "$(value one wrong_frames)" = 0 ]
awk -v share="$(value one tracked_share)" 'BEGIN { exit !(share > 0.9) }'

# Recorded images, of a camera and a target of one's own.
mkdir images
printf 'P5\n80 60\n255\n' >images/a.pgm
head -c 4800 /dev/zero >>images/a.pgm
cp images/a.pgm images/b.pgm
printf 'P5\n80 60\n255\n' >images/c.pgm
printf 'width = 80\nheight = 60\nfov = 90\n' >camera.toml
printf 'radius 0.01\n0 0 0\n0.2 0 0\n0 0.1 0\n0.05 0.06 0.15\n' >target.txt
"$bin/relative_localization" --images images --camera camera.toml --target target.txt --out none >/dev/null 2>&1
[ "$(value none frames)" = 2 ] && [ "$(value none bad_frames)" = 1 ]

refused relative_localization --images images --out out
refused relative_localization --images nowhere --camera camera.toml --out out
refused relative_localization --images images --camera none.toml --out out
printf 'width = 80\nheight = 60\n' >bare.toml
refused relative_localization --images images --camera bare.toml --out out
printf 'width = 90\nheight = 60\nfov = 90\n' >wide.toml
refused relative_localization --images images --camera wide.toml --out out
printf '0 0 0\n1 0 0\n2 0 0\n3 0 0\n' >line.txt
refused relative_localization --target line.txt --out out
printf '0 0 0\n1 0 0\n0 1 0\n' >three.txt
refused relative_localization --target three.txt --out out
refused relative_localization --markers blue --out out
refused relative_localization --distance 2 1 --out out
refused relative_localization --design --bounds 0.3 0.1 0.1 --out out
refused relative_localization --design --markers many --out out

"$bin/relative_localization" --design --starts 20 --out design >/dev/null
awk -v s="$(value design similarity)" 'BEGIN { exit !(s > 0.029) }'
"$bin/relative_localization" --target design/target_0.txt --frames 20 --out own >/dev/null 2>&1
