#!/usr/bin/env bash
# A shift with the controller in one network namespace and everybody else in another: workstation controller, Data System, Active
# Pedestal and vision, over TCP, and over Zenoh if the programs were built with it. Needs root, ip and python3; takes a minute.
#
#   tests/namespaces/shift.sh [DIRECTORY WITH rcs-run AND rcs-neighbour]     default: target/release
#
# The run is in fast clock, so its digest must be that of a run with everybody but the pedestal in the controller's own process
# (docs/neighbours.md, "The Active Pedestal"). Prints the item table of the Data System as the shift has left it.
set -euo pipefail
cd "$(dirname "$0")/../.."
programs=$(cd "${1:-target/release}" && pwd)

skip() { echo "skipped: $1"; exit 0; }
fail() { echo "FAILED: $1"; cat "$work"/*.err 2>/dev/null || true; exit 1; }
work=$(mktemp -d)
a=rcs-a-$$ b=rcs-b-$$
# Only what was started here.
cleanup() {
    jobs -p | xargs -r kill 2>/dev/null || true
    wait 2>/dev/null || true
    for space in "$a" "$b"; do ip netns del "$space" 2>/dev/null || true; done
    rm -rf "$work"
}
trap cleanup EXIT
[ "$(id -u)" = 0 ] || skip "not root"
command -v ip >/dev/null && command -v python3 >/dev/null || skip "no ip or python3 here"
ip netns add "$a" 2>/dev/null || skip "network namespaces are not permitted"
ip netns add "$b"
ip link add rcs-va netns "$a" type veth peer name rcs-vb netns "$b"
ip -n "$a" addr add 10.99.1.1/24 dev rcs-va
ip -n "$b" addr add 10.99.1.2/24 dev rcs-vb
for end in "$a rcs-va" "$b rcs-vb"; do
    read -r space interface <<< "$end"
    ip -n "$space" link set "$interface" up
    ip -n "$space" link set lo up
    ip -n "$space" route add 224.0.0.0/4 dev "$interface"
done
"$programs/rcs-neighbour" keys "$work/keys" > /dev/null

digest() { python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["digest"])' "$1"; }
"$programs/rcs-neighbour" pedestal --network "unix:$work/rcs.sock" --wait 20 > /dev/null 2> "$work/inside-pedestal.err" &
"$programs/rcs-run" shift --json --log none --shared-memory off --network "unix:$work/rcs.sock" --outside pedestal \
    > "$work/inside.json" 2> "$work/inside.err"
expected=$(digest "$work/inside.json")
echo "everybody but the pedestal in one process: digest $expected"

shifts=0
shift_over() { # ADDRESS
    local address=$1 servants=()
    items=$work/items-$((++shifts)).db
    neighbour() { ip netns exec "$b" "$programs/rcs-neighbour" "$1" --network "$address" --keys "$work/keys" --wait 20 "${@:2}"; }
    ip netns exec "$a" "$programs/rcs-run" shift --json --log none --shared-memory off --network "$address" --keys "$work/keys" \
        --outside workstation,data-system,pedestal,vision --outbox "$items.outbox" > "$work/run.json" 2> "$work/run.err" &
    local run=$!
    neighbour data-system "$items" > /dev/null 2> "$work/data-system.err" & servants+=($!)
    neighbour pedestal > /dev/null 2> "$work/pedestal.err" & servants+=($!)
    neighbour vision > /dev/null 2> "$work/vision.err" & servants+=($!)
    local began; began=$(date +%s%N)
    timeout 300 ip netns exec "$b" "$programs/rcs-neighbour" workstation --network "$address" --keys "$work/keys" --wait 20 shift \
        > /dev/null 2> "$work/workstation.err" || fail "the shift over $address"
    wait "$run" || fail "rcs-run over $address"
    local took=$((($(date +%s%N) - began) / 1000000))
    kill "${servants[@]}" 2>/dev/null || true
    local found; found=$(digest "$work/run.json")
    [ "$found" = "$expected" ] || fail "over $address the digest is $found"
    echo "over $address: digest $found, $took ms"
}

where() {
    python3 - "$items" <<'PYTHON'
import sqlite3, sys
rows = sqlite3.connect(sys.argv[1]).execute("SELECT * FROM whereabouts")
print("  ".join(f"{column[0]:12}" for column in rows.description))
for row in rows:
    print("  ".join(f"{value!s:12}" for value in row))
PYTHON
}

shift_over tcp:10.99.1.1:7400
where
if ip netns exec "$a" "$programs/rcs-run" --network zenoh:t3 --outside workstation --wait 1 --log none --shared-memory off 2>&1 | grep -q "features zenoh"; then
    echo "over zenoh: not tried, these programs are built without it"
else
    shift_over zenoh:t3@tcp/10.99.1.1:7447
    where
    # Without an endpoint they find each other by multicast.
    shift_over zenoh:t3
    where
fi
