# What the tests of the program share: source it, call checks, end with `finish`.
set -uo pipefail
: "${PENTAPRISM:?the program to test}"
unset PENTAPRISM_THREADS PENTAPRISM_ISA
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
checks=0 failures=0

fail() {
    failures=$((failures + 1))
    echo "FAILED: $*"
}

# run ARGUMENTS...: leaves $status and the files out and err.
run() {
    status=0
    timeout 120 "$PENTAPRISM" "$@" >"$work/out" 2>"$work/err" </dev/null || status=$?
}

# succeeds ARGUMENTS...
succeeds() {
    checks=$((checks + 1))
    run "$@"
    [[ $status == 0 ]] || fail "pentaprism $*: exit code $status: $(head -c 500 "$work/err")"
}

# refuses CODE REGEX ARGUMENTS...: that exit code, nothing on stdout, and exactly one line of error, which the regex matches.
refuses() {
    local code=$1 regex=$2
    shift 2
    checks=$((checks + 1))
    run "$@"
    [[ $status == "$code" ]] || fail "pentaprism $*: exit code $status instead of $code: $(head -c 500 "$work/err")"
    [[ ! -s $work/out ]] || fail "pentaprism $*: it printed on stdout: $(head -c 200 "$work/out")"
    [[ $(wc -l <"$work/err") == 1 ]] || fail "pentaprism $*: not one line: $(head -c 1000 "$work/err")"
    grep -qE "^pentaprism: error: .*$regex" "$work/err" || fail "pentaprism $*: '$(cat "$work/err")' does not match '$regex'"
}

# check TEXT COMMAND...: the command must succeed.
check() {
    local text=$1
    shift
    checks=$((checks + 1))
    "$@" || fail "$text"
}

# json FILE EXPRESSION: true when the Python expression on the document d is.
json() {
    python3 -c 'import json, sys; d = json.load(open(sys.argv[1])); sys.exit(0 if eval(sys.argv[2]) else 1)' "$1" "$2"
}

finish() {
    echo "$checks checks, $failures failures"
    [[ $failures == 0 && $checks -gt 0 ]]
}
