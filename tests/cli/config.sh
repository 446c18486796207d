#!/usr/bin/env bash
# What --print-config prints, --config reads as the same: of every program, every option that has a value.
set -eu
sources=$(cd "$(dirname "$0")/../../examples" && pwd)
. "$(dirname "$0")/support.sh"

# printed PROGRAM ARGUMENTS...: its settings; a place for each argument that it has to have.
printed() {
  local program=$1 places=()
  shift
  case $program in
    evaluate_reconstruction) places=(reference.ply result.ply) ;;
    fuse_depth | fuse_scans | solve_tour) places=(input) ;;
  esac
  "$bin/$program" "${places[@]}" "$@" --print-config
}

# returns PROGRAM FILE: fails unless the settings in FILE are printed as they are read.
returns() {
  printed "$1" --config "$2" >again.toml || fail "$1 refuses what it printed: $(cat "$2")"
  diff "$2" again.toml >difference.txt || fail "$1: other settings come back: $(cat difference.txt)"
}

programs=0
for source in "$sources"/[a-z]*.cpp; do
  program=$(basename "$source" .cpp)
  path=$bin/$program
  [ -x "$path" ] || continue  # for want of a package
  programs=$((programs + 1))
  "$path" --help >help.txt
  [ "$(grep -c '^[A-Z][A-Za-z0-9 ]*:$' help.txt)" -ge 3 ] && grep -q "^  $program .*--" help.txt ||
    fail "$program --help has no groups or no examples"
  "$path" --version | grep -qE '^Surfleet [0-9.]+$' || fail "$program --version"
  printed "$program" >default.toml
  returns "$program" default.toml
  flags=0 changed=0
  while read -r name _ value; do
    case $value in
      true) other=false ;;
      false) other=true ;;
      0) other=1 ;;
      *[!0-9.]* | *.*.*) continue ;;
      0.*) other=0.375 ;;
      *.*) other=3.5 ;;
      *) other=${value/#[0-9]/3} ;;
    esac
    [ "$other" != "$value" ] || other=${value/#[0-9]/2}
    sed "s/^$name = .*/$name = $other/" default.toml >changed.toml
    # A value that is out of bounds tells nothing; a flag has none.
    if ! printed "$program" --config changed.toml >first.toml 2>/dev/null; then
      [ "$value" != true ] && [ "$value" != false ] || fail "$program: $name = $other is refused"
      continue
    fi
    grep -qx "$name = $other" first.toml || fail "$program: $name = $other gave $(grep "^$name = " first.toml)"
    returns "$program" first.toml
    changed=$((changed + 1))
    [ "$value" != true ] && [ "$value" != false ] || flags=$((flags + 1))
  done <default.toml
  echo "$program: $(wc -l <default.toml) settings, $changed changed, $flags of them flags"
  [ "$changed" -gt 0 ] || fail "$program: nothing could be changed"
done
[ "$programs" -ge 11 ] || fail "only $programs programs"

# Flags that are on until they are taken back, from the command line and from a file.
for flag in sweep balance; do
  printed surface_coverage --no-$flag >off.toml
  grep -qx "$flag = false" off.toml || fail "--no-$flag is not printed"
  returns surface_coverage off.toml
  printed surface_coverage --config off.toml --$flag | grep -qx "$flag = true" || fail "--$flag"
done
# Text that TOML has signs of its own for.
for text in 'a b' 'a, b' 'a # b' '[a]' "it's" 'say "a"' '#'; do
  printed drone_inspection --out "$text" >text.toml
  returns drone_inspection text.toml
done
refused drone_inspection --out "it's \"a\"" --print-config
printed surface_coverage --out '' >empty.toml
grep -qx 'out = ""' empty.toml && returns surface_coverage empty.toml || fail "an empty text is lost"

# What another option stands in place of is no setting: what was printed is accepted.
printed drone_inspection_trials --scenes random:shell:1,house --gimbal --planners surfleet >scenes.toml
! grep -qE '^(scene|voxel) ' scenes.toml || fail "settings of one scene for several: $(cat scenes.toml)"
returns drone_inspection_trials scenes.toml
"$bin/plan_coverage_tour" missing.ply --print-config >tour.toml
refused plan_coverage_tour missing.ply --config tour.toml --out out
grep -q 'missing.ply' stderr.txt || fail "$(cat stderr.txt)"
"$bin/relative_localization" --design --print-config >design.toml
! grep -q '^markers ' design.toml || fail "a design has markers of images"
