#!/usr/bin/env bash
# The controller and its gateway in one network namespace, its workstation controller in another, and a bad line between them
# (relay.py, in a third): delay, loss, a short cut, and a long one that heals. Takes three minutes in real time, loads nothing,
# and needs root, ip and python3.
#
#   gateway/tests/namespaces/run.sh [DIRECTORY WITH rcs-run AND rcs-neighbour]     default: target/release
#
# Prints how long a command takes from one end of the line to the other and back, against one in the controller's own process.
set -euo pipefail
cd "$(dirname "$0")/../../.."
programs=$(cd "${1:-target/release}" && pwd)
gateway=gateway/target/release/rcs-gateway
commands=20

skip() { echo "skipped: $1"; exit 0; }
fail() { echo "FAILED: $1"; cat "$work/said" 2>/dev/null || true; exit 1; }
[ "$(id -u)" = 0 ] || skip "not root"
command -v ip >/dev/null && command -v python3 >/dev/null || skip "no ip or python3 here"
work=$(mktemp -d)
here=$$
a=rcs-a-$here b=rcs-b-$here line=rcs-line-$here
# Only what was started here.
cleanup() {
    exec 9>&- || true
    jobs -p | xargs -r kill 2>/dev/null || true
    wait 2>/dev/null || true
    for space in "$a" "$b" "$line"; do ip netns del "$space" 2>/dev/null || true; done
    rm -rf "$work"
}
trap cleanup EXIT
ip netns add "$a" 2>/dev/null || skip "network namespaces are not permitted"
ip netns add "$b"
ip netns add "$line"
end() { # NAMESPACE ADDRESS INTERFACE: its end of the line
    ip link add "rcs-$3" netns "$1" type veth peer name "rcs-$3" netns "$line"
    ip netns exec "$1" python3 gateway/tests/namespaces/relay.py plain "rcs-$3"
    ip -n "$1" addr add "$2/24" dev "rcs-$3"
    ip -n "$1" link set "rcs-$3" up
    ip -n "$1" link set lo up
    ip -n "$line" link set "rcs-$3" up
}
end "$a" 10.99.0.1 va
end "$b" 10.99.0.2 vb
mkfifo "$work/orders"
ip netns exec "$line" python3 gateway/tests/namespaces/relay.py rcs-va rcs-vb 1 < "$work/orders" &
exec 9> "$work/orders"
order() { echo "$*" >&9; }

tools/keys.sh "$work/keys" t3 10.99.0.1 hwsc > /dev/null
for _ in $(seq $((commands + 1))); do echo "== PAUSE -- +0 -- 0 +0 -- 0 -- 0"; done > "$work/short.job"
for _ in $(seq 40); do echo "== PAUSE -- +0 -- 0 +0 -- 0 -- 0"; echo "** wait 5"; done > "$work/long.job"

# Plays a job from the other namespace.
play() {
    timeout 120 ip netns exec "$b" "$programs/rcs-neighbour" workstation --network "unix:$work/hwsc.sock" \
        "$work/$1.job" > "$work/$1.out" 2> "$work/$1.err"
}
# Ticks of the commands but the first, which waits for the robot: the mean, and the longest.
ticks() {
    grep '^==' "$1" | tail -n +2 | sed 's/.* after \([0-9]*\) ticks/\1/' |
        awk '{ sum += $1; if ($1 > most) most = $1 } END { printf "%.1f %d", sum / NR, most }'
}
row() { # CONDITION MEAN LONGEST
    printf '%-32s  %7s  %7s  %s\n' "$1" "$2" "$3" "$(awk "BEGIN { printf \"%+.0f ms\", ($2 - $own) * 40 }")"
}

"$programs/rcs-run" "$work/short.job" --clock real --log none --shared-memory off --json > "$work/own.json"
own=$(python3 -c "import json, sys
done = [command['ticks'] for command in json.load(open(sys.argv[1]))['commands'][1:]]
print(sum(done) / len(done))" "$work/own.json")
printf '%-32s  %7s  %7s  %s\n' line ticks longest "added to a command (mean)"
printf '%-32s  %7.1f\n' "none: in the controller's process" "$own"

order 0 0 0
ip netns exec "$a" "$programs/rcs-run" --clock real --network "unix:$work/run.sock" --outside workstation --log none \
    --shared-memory off > "$work/page" 2> "$work/said" &
controller=$!
until [ -S "$work/run.sock" ]; do sleep 0.1; done
ip netns exec "$a" "$gateway" serve t3 tls/10.99.0.1:7447 --run "unix:$work/run.sock" --keys "$work/keys" \
    --allow workstation=hwsc 2> "$work/serve.err" &
until grep -q "t3 at tls" "$work/serve.err"; do sleep 0.1; done
ip netns exec "$b" "$gateway" connect t3@tls/10.99.0.1:7447 workstation "unix:$work/hwsc.sock" --keys "$work/keys" \
    --name hwsc 2> "$work/connect.err" &
until [ -S "$work/hwsc.sock" ]; do sleep 0.1; done
while read -r what condition; do
    order $condition
    play short || fail "$what: $(tail -1 "$work/short.err")"
    row "$what" $(ticks "$work/short.out")
done <<'CONDITIONS'
clean 0 0 0
20±5_ms_each_way 20 5 0
5_%_lost_each_way 0 0 5
20±5_ms_and_5_% 20 5 5
CONDITIONS
order 0 0 0
(sleep 3; order cut; sleep 1; order 0 0 0) &
cutter=$!
play long || fail "cut for 1 s: $(tail -1 "$work/long.err")"
wait "$cutter"
row "cut for 1 s" $(ticks "$work/long.out")
(sleep 3; order cut; sleep 15; order 0 0 0) &
cutter=$!
if play long; then fail "a job over a line that was cut for 15 s has finished"; fi
printf '%-32s  %s\n' "cut for 15 s" "$(tail -1 "$work/long.err")"
wait "$cutter"
kill -0 "$controller" || fail "the controller has ended"
play short || fail "healed: $(tail -1 "$work/short.err")"
row "healed" $(ticks "$work/short.out")
kill -TERM "$(pgrep -P "$controller" -x rcs-run || echo "$controller")"
wait "$controller" || fail "the controller ended with $?"
echo "the controller's events: $(grep -oE 'has disconnected: [^"]*' "$work/page" | sort | uniq -c | sort -rn | tr -s ' ' | paste -sd ';')"
echo "passed"
