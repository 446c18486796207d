#!/usr/bin/env bash
# Recorded images and scans: what a mission saves gives its map again, what cannot be used is counted
# or refused, and what comes out is whole.
set -eu
. "$(dirname "$0")/support.sh"

# Half a minute of two drones; their images give the same surface as their mission did.
status=0
"$bin/drone_inspection" --scene house --robots 2 --max-time 30 --quiet --save-images shots --out flight \
  >flight.txt || status=$?
[ $status = 3 ] || fail "the flight ended with $status"
images=$(value flight images)
[ "$(ls shots/*.depth.png | wc -l)" = "$images" ] && [ "$(ls shots/*.pose.txt | wc -l)" = "$images" ] ||
  fail "not every image was saved"
for threads in 1 2; do
  "$bin/fuse_depth" shots --config shots/fuse_depth.toml --threads $threads --quiet --out fused$threads \
    >fused.txt
done
for file in reconstruction.ply points.ply map.sfm next_viewpoints.json next_viewpoints.tum sensors.tum \
    report.html; do
  [ -s fused1/$file ] || fail "fused1/$file is missing"
done
for file in reconstruction.ply points.ply map.sfm next_viewpoints.json next_viewpoints.tum; do
  cmp fused1/$file fused2/$file
done
[ "$(value fused1 frames)" = "$images" ] && [ "$(value fused1 frames_skipped)" = 0 ]
for pair in "flight fused1" "fused1 flight"; do
  set -- $pair
  "$bin/evaluate_reconstruction" "$1/map.sfm" "$2/map.sfm" --emax 0.02 >judged.txt
  awk '/"unsided_coverage"/ { if ($2 + 0 < 0.98) { print; exit 1 } }' judged.txt ||
    fail "$2 lacks what $1 has"
done
# As many viewpoints as are said to be, each where the camera's pose is written too.
[ "$(grep -vc '^#' fused1/next_viewpoints.tum)" = "$(value fused1 next_viewpoints)" ]
[ "$(grep -c '"quaternion_xyzw"' fused1/next_viewpoints.json)" = "$(value fused1 next_viewpoints)" ]
[ "$(value fused1 next_viewpoints)" -gt 0 ] || fail "no next viewpoint"

# The same recording as TUM RGB-D: units by --depth-scale, lines as on another system.
mkdir -p tum/depth
printf '# depth\r\n' >tum/depth.txt
printf '# truth\r\n' >tum/groundtruth.txt
n=0
for image in shots/*.depth.png; do
  name=$(basename "$image")
  cp "$image" tum/depth/
  printf '%d.004 depth/%s\r\n' $n "$name" >>tum/depth.txt
  n=$((n + 1))
done
awk '!/^#/ { $1 = NR - 2; print }' fused1/sensors.tum | tr -d '\r' | sed 's/$/\r/' >>tum/groundtruth.txt
cp shots/camera-intrinsics.txt tum/
"$bin/fuse_depth" tum --config shots/fuse_depth.toml --depth-scale 1000 --quiet --out fused3 >tum.txt
[ "$(value fused3 frames)" = "$images" ] || fail "TUM: $(cat tum.txt)"
"$bin/evaluate_reconstruction" fused1/reconstruction.ply fused3/reconstruction.ply --emax 0.02 >judged.txt
awk '/"unsided_coverage"/ { if ($2 + 0 < 0.999) { print; exit 1 } }' judged.txt || fail "TUM differs"
"$bin/fuse_depth" tum --config shots/fuse_depth.toml --depth-scale 1000 --max-time-off 0.001 --quiet \
  --out none 2>refused.txt && fail "images without poses were fused"
grep -q 'no_pose' refused.txt && [ ! -e none ] || fail "$(cat refused.txt)"

# One of every kind that cannot be used.
cp -r shots bad
cd bad
set -- $(ls *.depth.png)
printf '1 0 0 0\n0 2 0 0\n0 0 1 0\n0 0 0 1\n' >"${1%.depth.png}.pose.txt"
printf '1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >"${2%.depth.png}.pose.txt"
rm "${3%.depth.png}.pose.txt"
head -c 700 "$4" >cut && mv cut "$4"
printf 'not an image' >"$5"
rm "$6"
# 8-bit grey, and of another size: a header is enough to tell.
printf '\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\0\240\0\0\0\134\010\0\0\0\0\0\0\0\0' >"$7"
printf '\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\0\012\0\0\0\012\020\0\0\0\0\0\0\0\0' >"$8"
cd ..
"$bin/fuse_depth" bad --config shots/fuse_depth.toml --quiet --out fused4 >skipped.txt
[ "$(value fused4 frames)" = $((images - 8)) ] && [ "$(value fused4 frames_skipped)" = 8 ] ||
  fail "skipped: $(cat skipped.txt)"
for count in 'bad_pose 2' 'no_pose 1' 'bad_image 3' 'no_image 1' 'other_size 1'; do
  grep -q "$count" skipped.txt || fail "no $count in: $(cat skipped.txt)"
done

# One bad frame of six, in either layout, is counted, and the others make the map; or it is refused.
six() {
  rm -rf six && mkdir -p six/depth
  cp shots/camera-intrinsics.txt six/
  local n=0 name shot
  printf '# poses\n' >six/groundtruth.txt
  for shot in $(ls shots/*.depth.png | head -n 6); do
    name=$n
    n=$((n + 1))
    if [ "$1" = scenes ]; then
      cp "$shot" six/$name.depth.png && cp "${shot%.depth.png}.pose.txt" six/$name.pose.txt
    else
      cp "$shot" six/depth/$name.png && echo "$name.01 depth/$name.png" >>six/depth.txt
      awk -v n=$n '!/^#/ { if (++k == n) { $1 = n - 1; print } }' fused1/sensors.tum >>six/groundtruth.txt
    fi
  done
  [ "$1" = tum ] || rm -r six/depth six/groundtruth.txt
}
# tum_pose NUMBERS: in place of what stands after the time of the frame in the middle.
tum_pose() { sed -i "s/^3 .*/3 $1/" six/groundtruth.txt; }
small_png='\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\0\012\0\0\0\012\020\0\0\0\0\0\0\0\0'
for layout in scenes tum; do
  [ $layout = scenes ] && image=six/3.depth.png || image=six/depth/3.png
  for fault in no_image no_pose bad_image other_size bad_pose nan bad_line; do
    reason=$fault
    six $layout
    case $layout.$fault in
      *.no_image) rm $image ;;
      *.bad_image) head -c 700 $image >cut.png && mv cut.png $image ;;
      *.other_size) printf "$small_png" >$image ;;
      scenes.no_pose) rm six/3.pose.txt ;;
      tum.no_pose) sed -i '/^3 /d' six/groundtruth.txt ;;
      scenes.bad_pose) printf '1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n' >six/3.pose.txt ;;
      tum.bad_pose) tum_pose '0 0 0 0 0 0 0' ;;
      scenes.nan) printf '1 0 0 0\n0 1 0 nan\n0 0 1 0\n0 0 0 1\n' >six/3.pose.txt && reason=bad_pose ;;
      tum.nan) tum_pose '0 0 nan 0 0 0 1' && reason=bad_pose ;;
      scenes.bad_line) printf '1 0 0 0\n0 1 0' >six/3.pose.txt && reason=bad_pose ;;
      tum.bad_line) sed -i 's/^3.01.*/3.01/' six/depth.txt ;;
    esac
    options="six --config shots/fuse_depth.toml --depth-scale 1000 --views 0 --quiet"
    "$bin/fuse_depth" $options --out five >five.txt || fail "$layout, $fault: refused"
    [ "$(value five frames)" = 5 ] && [ "$(value five frames_skipped)" = 1 ] && grep -q "$reason 1" five.txt ||
      fail "$layout, $fault: $(cat five.txt)"
    refused fuse_depth $options --strict --out out
  done
  six $layout
  "$bin/fuse_depth" $options --strict --out five >five.txt || fail "$layout: six good frames are refused"
done
# A file of poses that is none leaves no frame.
printf 'not a pose\n' >six/groundtruth.txt
refused fuse_depth $options --out out

refused fuse_depth bad --strict --quiet --config shots/fuse_depth.toml --out out
# A file that is cut short is found out half way, and even then nothing is written.
mkdir cut && cp bad/camera-intrinsics.txt cut
cp "bad/$4" cut/a.depth.png && cp "bad/${4%.depth.png}.pose.txt" cut/a.pose.txt
refused fuse_depth cut --quiet --out out
refused fuse_depth cut --quiet --strict --out out
mkdir empty dark
refused fuse_depth empty --out out
refused fuse_depth missing --out out
cp "shots/$8" dark/a.depth.png && cp "shots/${8%.depth.png}.pose.txt" dark/a.pose.txt
refused fuse_depth dark --out out # no intrinsics
refused fuse_depth dark --quiet --intrinsics 80 80 500 40 --out out
refused fuse_depth dark --quiet --intrinsics 80 -80 80 40 --out out
refused fuse_depth dark --quiet --intrinsics 80 80 80 40 --depth-scale 0 --out out
refused fuse_depth dark --quiet --intrinsics 80 80 80 40 --depth-scale 1e9 --out out # no surface
for options in '--voxel 0' '--voxel nan' '--range 4 1' '--range 1 inf' '--truncation 0.001' \
    '--known-weight 0' '--up 0 0 0' '--threads 0' '--standoff 99' '--bounds 1 1 1 0 0 0' '--views -1'; do
  refused fuse_depth shots $options --out out
  refused fuse_scans shots $options --out out
done
refused drone_inspection --scene house --range 1 70 --save-images out --out out

# A wall of 4 x 4 m scanned from two places, as clouds with poses or a trajectory.
mkdir scans
awk 'BEGIN { for (y = -2; y <= 2; y += 0.05) for (z = -2; z <= 2; z += 0.05) print 3, y, z }' >scans/1.xyz
awk 'BEGIN { for (y = -2; y <= 2; y += 0.05) for (z = -2; z <= 2; z += 0.05) print 4, y - 0.5, z }' >scans/2.xyz
printf '1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\n0 0 0 1\r\n' >scans/1.pose.txt
printf '1 0 0 -1\n0 1 0 0.5\n0 0 1 0\n0 0 0 1\n' >scans/2.pose.txt
printf '# t\n10 0 0 0 0 0 0 1\n20 -1 0.5 0 0 0 0 1\n' >walk.tum
printf '0.95 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n2.01 -1 0.5 0 0 0 0 1\n' >stamped.tum
"$bin/fuse_scans" scans --voxel 0.1 --range 0.5 10 --quiet --out wall1 >wall.txt
"$bin/fuse_scans" scans --voxel 0.1 --range 0.5 10 --trajectory walk.tum --quiet --out wall2 >wall.txt
"$bin/fuse_scans" scans --voxel 0.1 --range 0.5 10 --trajectory stamped.tum --quiet --out wall3 >wall.txt
cmp wall1/map.sfm wall2/map.sfm
cmp wall1/map.sfm wall3/map.sfm
# 16 square metres, and at most a voxel and three quarters beyond the border: rays that meet it aslant
# give distances behind the wall that far out.
awk -v a="$(value wall1 mesh_area_m2)" 'BEGIN { if (a < 15 || a > 18.8) { print "wall of", a; exit 1 } }'
"$bin/fuse_scans" scans --voxel 0.1 --range 0.5 10 --up 1 0 0 --quiet --out floor >floor.txt
[ "$(value floor mesh_triangles)" -gt 100 ]
# Times with more decimals or fewer are numbers, whatever the order of their names; what has no pose near is
# counted, though there be as many.
mkdir timed
cp scans/1.xyz timed/9.25.xyz && cp scans/2.xyz timed/10.5.xyz && cp scans/1.xyz timed/11.xyz
printf '9.250000 0 0 0 0 0 0 1\n10.5100 -1 0.5 0 0 0 0 1\n30 5 5 5 0 0 0 1\n' >timed.tum
"$bin/fuse_scans" timed --voxel 0.1 --range 0.5 10 --trajectory timed.tum --quiet --out wall5 >wall.txt
cmp wall1/map.sfm wall5/map.sfm
[ "$(value wall5 frames)" = 2 ] && grep -q 'no_pose 1' wall.txt || fail "$(cat wall.txt)"
refused fuse_scans timed --voxel 0.1 --range 0.5 10 --trajectory timed.tum --strict --quiet --out out
refused fuse_scans timed --voxel 0.1 --range 0.5 10 --trajectory timed.tum --max-time-off 0.001 --strict --out out
# A pose that is not rigid costs its scan.
rm timed/11.xyz
printf '9.25 0 0 0 0 0 0 1\n10.5 -1 0.5 0 0 0 0 0.5\n' >timed.tum
"$bin/fuse_scans" timed --voxel 0.1 --range 0.5 10 --trajectory timed.tum --quiet --out wall6 >wall.txt
[ "$(value wall6 frames)" = 1 ] && grep -q 'bad_pose 1' wall.txt || fail "$(cat wall.txt)"
refused fuse_scans timed --voxel 0.1 --range 0.5 10 --trajectory timed.tum --strict --quiet --out out
rm scans/2.pose.txt && echo '1 2' >scans/3.xyz && cp scans/1.pose.txt scans/3.pose.txt
"$bin/fuse_scans" scans --voxel 0.1 --range 0.5 10 --quiet --out wall4 >wall.txt
grep -q 'no_pose 1' wall.txt && grep -q 'bad_scan 1' wall.txt || fail "$(cat wall.txt)"
refused fuse_scans scans --strict --quiet --out out
refused fuse_scans scans --trajectory walk.tum --max-time-off 0 --quiet --out out
refused fuse_scans empty --out out
for program in fuse_depth fuse_scans; do
  "$bin/$program" --help >help.txt
  grep -q 'Examples:' help.txt && grep -q -- --known-weight help.txt || fail "$program --help"
done
