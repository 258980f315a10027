# For the scripts that source it: runs a command with its output in the file $log, and shows that only if it fails.
quietly() {
  "$@" >"$log" 2>&1 && return
  cat "$log" >&2
  echo "error: scripts/$(basename "$0"): '$*' failed; its output is above" >&2
  exit 1
}
