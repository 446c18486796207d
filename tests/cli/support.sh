# For the scripts here: `bin` is the folder of programs, the current one is empty and goes at the end.
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

# value FOLDER KEY: what its metrics.json says first of a key.
value() { grep "\"$2\":" "$1/metrics.json" | head -n 1 | sed 's/.*: //; s/,.*//'; }

# lasting FOLDER: its metrics.json without what depends on the machine.
lasting() { grep -vE '"(wall_time_s|planning_time_s|(mission_)?peak_memory_bytes)"' "$1/metrics.json"; }

# fail WORDS: says them and ends the test.
fail() { echo "$*"; exit 1; }

# refused PROGRAM ARGUMENTS...: fails unless it ends with status 2 after one line of explanation and
# leaves no folder `out`.
refused() {
  local program=$1 status=0 lines
  shift
  "$bin/$program" "$@" >stdout.txt 2>stderr.txt </dev/null || status=$?
  lines=$(wc -l <stderr.txt)
  if [ "$status" != 2 ] || [ "$lines" != 1 ] || [ -s stdout.txt ] || [ -e out ]; then
    head -n 3 stderr.txt
    fail "not refused properly: $program $*: status $status, $lines lines on stderr," \
      "$(wc -c <stdout.txt) bytes on stdout; $(ls -d out 2>/dev/null)"
  fi
}

# until_true SECONDS COMMAND...: waits for it to be true; fails if it is not by then.
until_true() {
  local tries=$((10 * $1))
  shift
  for _ in $(seq "$tries"); do
    "$@" && return 0
    sleep 0.1
  done
  return 1
}

# lines FILE NUMBER: whether it has so many, or more.
lines() { [ -e "$1" ] && [ "$(wc -l <"$1")" -ge "$2" ]; }
