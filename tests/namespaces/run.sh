#!/usr/bin/env bash
# The controller in one network namespace, its workstation controller in another, and a bad line between them: delay, loss, a short
# cut that heals, and a long one. Takes two minutes in real time; needs root, ip and tc.
#
#   tests/namespaces/run.sh [DIRECTORY WITH rcs-run AND rcs-neighbour]     default: target/release
#
# Prints how many ticks of 40 ms a command takes from one end of the line to the other and back.
set -euo pipefail
cd "$(dirname "$0")/../.."
programs=${1:-target/release}

skip() { echo "skipped: $1"; exit 0; }
[ "$(id -u)" = 0 ] || skip "not root"
command -v ip >/dev/null && command -v tc >/dev/null || skip "no ip or tc here"
ip netns add rcs-a 2>/dev/null || skip "network namespaces are not permitted"
work=$(mktemp -d)
# Only what was started here.
cleanup() {
    jobs -p | xargs -r kill 2>/dev/null || true
    wait 2>/dev/null || true
    ip netns del rcs-a 2>/dev/null || true
    ip netns del rcs-b 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
ip netns add rcs-b
ip link add rcs-va netns rcs-a type veth peer name rcs-vb netns rcs-b
ip -n rcs-a addr add 10.99.0.1/24 dev rcs-va
ip -n rcs-b addr add 10.99.0.2/24 dev rcs-vb
ip -n rcs-a link set rcs-va up
ip -n rcs-b link set rcs-vb up

(umask 077; head -c 24 /dev/urandom | base64 > "$work/secret")
{ for _ in 1 2 3 4 5; do echo "== PAUSE -- +0 -- 0 +0 -- 0 -- 0"; done; } > "$work/short.job"
{ for _ in $(seq 40); do echo "== PAUSE -- +0 -- 0 +0 -- 0 -- 0"; echo "** wait 5"; done; } > "$work/long.job"

ip netns exec rcs-a "$programs/rcs-run" --clock real --network tcp:10.99.0.1:7400 --outside workstation \
    --secret "$work/secret" --log none --shared-memory off > "$work/page" 2> "$work/said" &
controller=$!

# Plays a job from the other namespace; the ticks of its commands but the first, which waits for the robot, on one line.
play() {
    ip netns exec rcs-b "$programs/rcs-neighbour" workstation --network tcp:10.99.0.1:7400 \
        --secret "$work/secret" "$work/$1.job" > "$work/$1.out" 2> "$work/$1.err"
}
ticks() { grep '^==' "$work/$1.out" | tail -n +2 | sed 's/.* after \([0-9]*\) ticks/\1/' | xargs; }

play short
echo "clean line:                      ticks a command took: $(ticks short)"

netem=(root netem delay 25ms 5ms loss 5%)
if tc -n rcs-a qdisc add dev rcs-va "${netem[@]}" 2>/dev/null && tc -n rcs-b qdisc add dev rcs-vb "${netem[@]}"; then
    play short
    echo "50 ms there and back, 5 % lost:  ticks a command took: $(ticks short)"
else
    echo "not tried: delay and loss, this kernel has no netem"
fi

(sleep 3; ip -n rcs-b link set rcs-vb down; sleep 1; ip -n rcs-b link set rcs-vb up) &
cutter=$!
play long
wait "$cutter"
echo "cut for 1 s, healed:             finished; the longest command took $(ticks long | tr ' ' '\n' | sort -n | tail -1) ticks"

(sleep 3; ip -n rcs-b link set rcs-vb down) &
cutter=$!
if play long; then echo "FAILED: a job over a cut line has finished"; exit 1; fi
wait "$cutter"
echo "cut for good:                    $(tail -1 "$work/long.err")"
kill -0 "$controller" || { echo "FAILED: the controller has ended"; cat "$work/said"; exit 1; }
ip -n rcs-b link set rcs-vb up
play short
echo "healed later:                    ticks a command took: $(ticks short)"

kill -TERM "$controller"
wait "$controller" || { echo "FAILED: the controller ended with $?"; cat "$work/said"; exit 1; }
grep -E 'has (connected|gone)|refused' "$work/page" || true
echo "passed"
