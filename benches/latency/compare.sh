#!/usr/bin/env bash
# Wake-up latency of rcs-run beside cyclictest, on the 40 ms grid and under load: both at once, on a core each, then with
# the cores exchanged. Prints p50, p99 and max of both and the ratio of the p99 (promised: 1.5, aimed at: 1.1).
#
#   benches/latency/compare.sh [SECONDS] [LOAD]      SECONDS per round (60); LOAD for stress-ng, none for no load
#
# Needs cyclictest (Debian: rt-tests), stress-ng, two cores, and the right to SCHED_FIFO (root, or rtprio in
# limits.conf). Without that right both run as ordinary threads, and the figures say nothing about real time.
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:-60}
load=${2:---cpu $(( $(nproc) * 2 )) --vm 1 --vm-bytes 64M --hdd 1 --hdd-bytes 64M --timer 1}
for tool in cyclictest stress-ng; do
    command -v "$tool" > /dev/null || { echo "$tool is missing: apt-get install rt-tests stress-ng" >&2; exit 2; }
done
[ "$(nproc)" -ge 2 ] || { echo "two cores are needed, one for each of both" >&2; exit 2; }

cargo build --release --quiet
rcs_run=${CARGO_TARGET_DIR:-target}/release/rcs-run
place=$(mktemp -d)
stress=
finish() {
    [ -z "$stress" ] || { kill "$stress" 2> /dev/null && wait "$stress" 2> /dev/null; } || true
    rm -rf "$place"
}
trap finish EXIT

if [ "$load" != none ]; then
    # shellcheck disable=SC2086 # the load is a list of options
    stress-ng --quiet --temp-path "$place" $load &
    stress=$!
    sleep 2
fi

# p50, p99 and max in microseconds of a histogram of cyclictest, and of the JSON of rcs-run latency.
of_cyclictest() {
    awk '/^[0-9]/ { count[$1 + 0] = $2; total += $2; if ($2 > 0) max = $1 + 0 }
         /^# Max Latencies/ { worst = $4 + 0 }
         END { for (us = 0; us <= max; us++) { seen += count[us]
                   if (!p50 && seen >= total * 0.50) p50 = us
                   if (!p99 && seen >= total * 0.99) p99 = us }
               print p50, p99, (worst > max ? worst : max) }' "$1"
}
of_rcs_run() {
    sed -n 's/.*"late_us":{"p50":\([0-9.]*\),"p99":\([0-9.]*\),"p999":[0-9.]*,"max":\([0-9.]*\)}.*/\1 \2 \3/p' "$1"
}

for round in 1 2; do
    ours=$(( round % 2 )) theirs=$(( (round + 1) % 2 ))
    cyclictest --quiet --mlockall --priority 80 --interval 40000 --threads 1 --affinity "$theirs" \
        --duration "$seconds" --histogram 20000 > "$place/cyclictest" 2> "$place/said" &
    beside=$!
    "$rcs_run" latency --seconds "$seconds" --cpu "$ours" --json > "$place/rcs-run"
    wait "$beside" || { cat "$place/said" >&2; exit 2; }
    read -r p50 p99 max < <(of_rcs_run "$place/rcs-run")
    read -r c50 c99 cmax < <(of_cyclictest "$place/cyclictest")
    echo "round $round, ${seconds} s, load: $load"
    printf '  %-10s core %s  p50 %8.1f us  p99 %8.1f us  max %8.1f us\n' rcs-run "$ours" "$p50" "$p99" "$max"
    printf '  %-10s core %s  p50 %8.1f us  p99 %8.1f us  max %8.1f us\n' cyclictest "$theirs" "$c50" "$c99" "$cmax"
    ours99[round]=$p99 theirs99[round]=$c99
    sed -n 's/.*"realtime":"\([^"]*\)".*/  rcs-run: \1/p' "$place/rcs-run"
done
awk -v a="${ours99[1]}" -v b="${ours99[2]}" -v c="${theirs99[1]}" -v d="${theirs99[2]}" 'BEGIN {
    printf "p99 of rcs-run is %.2f x that of cyclictest (geometric mean of both rounds)\n", sqrt((a * b) / (c * d)) }'
