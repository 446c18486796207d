#!/usr/bin/env bash
# Bad input gets one clear line and exit status 2, and nothing is written.
set -eu
. "$(dirname "$0")/support.sh"

printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n' >truncated.ply
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n' >faceless.off
printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' >nan.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >range.obj
printf 'not a mesh' >garbage.stl
: >empty.ply
mkdir folder.ply
for file in missing.ply truncated.ply faceless.off nan.obj range.obj garbage.stl empty.ply folder.ply \
    mesh.xyz; do
  refused drone_inspection --scene "$file" --out out
  refused plan_coverage_tour "$file" --out out
  refused evaluate_reconstruction "$file" "$file" --out out
  refused surface_coverage --scene "$file" --out out
  refused surface_navigation --scene "$file" --out out
done
refused drone_inspection --scene house --start 0 0 1 --out out
refused drone_inspection --scene house --robots 0 --out out
refused drone_inspection --scene house --robots 500 --out out
refused drone_inspection --scene house --voxel -0.3 --out out
refused drone_inspection --scene house --voxel nan --out out
refused drone_inspection --scene house --fov 200 60 --out out
refused drone_inspection --scene house --range 8 1 --out out
refused drone_inspection --scene house --sensor nose --out out
refused drone_inspection --scene house --weight heavy --out out
refused drone_inspection --scene house --sensor lidar --lidar-range 8 1 --out out
refused drone_inspection --scene house --sensor lidar --lidar-fov 10 40 --out out
refused drone_inspection --scene house --sensor lidar --lidar-fov -80 80 --lidar-range 2 8 --out out
refused drone_inspection --scene house --sensor lidar --lidar-beams 0 64 --out out
refused drone_inspection --scene house --sensor lidar --lidar-noise -1 --out out
refused drone_inspection --scene house --sensor lidar --camera-pitch 10 --out out
refused drone_inspection --scene house --sensor lidar --gimbal --out out
refused drone_inspection --scene house --sensor lidar --save-images images --out out
refused drone_inspection --scene house --weight constant --save-images images --out out
refused drone_inspection --scene house --planner magic --out out
refused drone_inspection --scene house --preset magic --out out
refused drone_inspection --scene house --noise maybe --out out
refused drone_inspection --scene house --threads 0 --out out
refused drone_inspection --scene house --max-time -1 --out out
refused drone_inspection --scene house --bounds 1 1 1 0 0 0 --out out
refused drone_inspection --scene house --config missing.toml --out out
refused drone_inspection --scene house --unknown-option --out out
refused drone_inspection --scene house --seed -1 --out out
refused drone_inspection --scene house --robots 1.5 --out out
refused drone_inspection --scene house --ground 1 --out out
refused drone_inspection --scene house --bounds 40 40 1.5 60 60 10 --start 50 50 5 --out out
refused drone_inspection --scene house --neighbours blind --out out
refused drone_inspection --scene house --gimbal --planner tsga --out out
refused drone_inspection --scene house --gimbal --gimbal-pitch 0 --out out
refused drone_inspection --scene house --gimbal --gimbal-pitch 70 --camera-pitch 20 --out out
refused drone_inspection --scene house --gimbal-pitch 40 --out out
refused drone_inspection_trials --scene house --gimbal --out out
refused drone_inspection --scene house --announcements maybe --out out
refused drone_inspection --scene house --least-gain -1 --out out
refused drone_inspection --scene house --coverage-goal 2 --out out
refused drone_inspection --scene house --endurance-m 0 --out out
refused drone_inspection --scene house --endurance-s nan --out out
refused drone_inspection --scene house --continue nowhere --out out
refused drone_inspection --scene house --architecture single --robots 2 --out out
refused drone_inspection --scene house --start-clearance 0.5 --out out
refused drone_inspection --scene house --start-clearance 4.5 --out out
grep -q 'has 4.03 m around it; expected at most 4.03 ' stderr.txt || fail "$(cat stderr.txt)"
refused drone_inspection --scene house --start 0 -4.5 2 --out out
refused drone_inspection --scene house --floor low --out out
refused drone_inspection --scene house --floor 1.5 --out out
refused drone_inspection --scene house --floor 90 --out out
refused drone_inspection --scene house --keep-out 1 2 3 --out out
for body in ellipsoid ellipsoid:1,2 ellipsoid:1,0,1 box:1,2,3,4 box:1,nan,1 box:9,9,9 cube:1,1,1; do
  refused drone_inspection --scene house --body $body --out out
done
refused drone_inspection --scene house --radius 0.2 --body ellipsoid:0.6,0.6,0.2 --out out
refused drone_inspection --scene house --keep-out 1 1 1 0 0 0 --out out
refused drone_inspection --scene house --keep-out -2 -8 0 2 -6 4 --out out
echo 'robotss = 7' >misspelt.toml
printf '\x00\xff garbage [[[' >garbage.toml
echo 'fov = [90, 200]' >wide.toml
for file in misspelt.toml garbage.toml wide.toml; do
  refused drone_inspection --scene house --config $file --out out
  refused planar_coverage --config $file --out out
done
# A drawing in millimetres, or of a county.
printf 'v 0 0 0\nv 20000 0 0\nv 20000 20000 0\nv 0 20000 10\nf 1 2 3\nf 1 3 4\n' >county.obj
refused drone_inspection --scene county.obj --out out
refused drone_inspection --scene house --out stderr.txt
refused drone_inspection --scene house --out /proc/out
for name in random random: random:shell random:castle:1 random:shell: random:shell:-1 random:shell:+1 \
    random:shell:1.5 random:shell:1e3 random:shell:1:2 random:shell:99999999999999999999999 random:all:x \
    random:shell:1-5; do
  refused drone_inspection --scene "$name" --out out
done
for name in random:shell:5-1 random:shell:1- random:all:1-99999 random:castle:1-2 house,random:shell:x \
    random:shell:1,missing.ply; do
  refused drone_inspection_trials --scenes "$name" --out out
done
refused drone_inspection_trials --scenes random:shell:1 --scene house --out out
refused drone_inspection --scene random:shell:1 --ground 0 --out out
refused plan_coverage_tour missing.ply --scene house --out out
refused plan_coverage_tour --scene house --coverage 1.5 --out out
refused plan_coverage_tour --scene house --standoff 0.5 --out out
refused plan_coverage_tour --scene house --spacing 0 --out out
refused plan_coverage_tour --scene house --density -1 --out out
refused plan_coverage_tour --scene house --planner tsga --out out
refused plan_coverage_tour --scene house --start 0 0 1 --out out
refused drone_inspection_trials --scene house --planners magic --out out
refused drone_inspection_trials --scene house --trials 0 --out out

printf 'SFLTTSDF\001\000\000\000' >cut.sfm
printf 'not a map' >garbage.sfm
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >triangle.off
for file in cut.sfm garbage.sfm missing.sfm; do
  refused evaluate_reconstruction triangle.off $file --out out
done
for file in misspelt.toml garbage.toml; do
  refused evaluate_reconstruction --config $file triangle.off triangle.off --out out
done

# What is refused leaves a folder that is there as it was.
mkdir kept
echo before >kept/metrics.json
refused drone_inspection --scene missing.ply --out kept
refused drone_inspection --scene house --robots 0 --out kept
[ "$(ls -A kept)" = metrics.json ] && [ "$(cat kept/metrics.json)" = before ] ||
  fail "a refusal changed a folder: $(ls -A kept)"

printf 'NAME: x\nTYPE: TSP\nDIMENSION: 1000000000\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n1\nEOF\n' >huge.tsp
printf 'TYPE: TSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 x 0\n3 0 1\nEOF\n' >letters.tsp
for file in missing.tsp huge.tsp letters.tsp garbage.stl; do refused solve_tour "$file"; done

printf '{"outer": [[0,0],[1,1],[1,0],[0,1]]}' >bow_tie.json
printf '{"outer": [[0,0],[4,0],[4,4],[0,4]], "holes": [[[5,5],[6,5],[6,6]]]}' >hole_outside.json
for file in missing.json bow_tie.json hole_outside.json garbage.stl; do
  refused planar_coverage --scene "$file" --out out
done
refused planar_coverage --robots 0 --out out
refused surface_coverage --robots 0 --out out
refused surface_navigation --goal 0 0 9 --out out
refused surface_navigation --goal 0 0 --out out
refused surface_navigation --start nan 0 0 --out out
refused surface_navigation --slope 1 --out out
refused surface_navigation --blocked nowhere.txt --out out
refused surface_navigation --cover --robot magnebike --out out
refused surface_coverage --scene sphere --robots 100000000 --out out
