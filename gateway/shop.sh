#!/usr/bin/env bash
# A shop on one machine: a router, and five simulated cells, each with its gateway and a workstation controller behind it.
#
#   gateway/shop.sh [DIRECTORY]                       default: shop; keys, sockets and messages of the processes are there
#   gateway/target/release/rcs-gateway monitor tls/127.0.0.1:7447 --keys shop/keys --name mes
#
# The first command runs until Ctrl-C. Each cell plays the linkbar, and then moves to and fro. RCS_SHOP_PORT is the port of the
# router (7447); those of the gateways follow it. RCS_PROGRAMS names another directory than target/release, RCS_GATEWAY another
# program than gateway/target/release/rcs-gateway.
set -euo pipefail
directory=${1:-shop}
mkdir -p "$directory"
directory=$(cd "$directory" && pwd)
cd "$(dirname "$0")/.."
programs=${RCS_PROGRAMS:-target/release}
gateway=${RCS_GATEWAY:-gateway/target/release/rcs-gateway}
router=${RCS_SHOP_PORT:-7447}
cells=(c1 c2 c3 c4 c5)
for program in "$programs/rcs-run" "$programs/rcs-neighbour" "$gateway"; do
    [ -x "$program" ] || {
        echo "shop.sh: $program is missing: cargo build --release, and (cd gateway && cargo build --release)" >&2
        exit 2
    }
done

cleanup() {
    trap - EXIT
    # Only processes that were started here.
    kill $(jobs -p) 2>/dev/null || true
    wait 2>/dev/null || true
}
trap cleanup EXIT
trap 'exit 0' INT TERM

stations=("${cells[@]/#/hwsc-}")
tools/keys.sh "$directory/keys" c1 127.0.0.1 router@127.0.0.1 mes "${cells[@]/%/@127.0.0.1}" "${stations[@]}"
printf '%s\n' '== MOVE -- 0 -- 0 0 SAFE 0 -- 0' '== MOVE -- 0 -- 0 0 HOME 0 -- 0' > "$directory/to-and-fro.job"

# Starts a program whose messages are in a file.
start() { # NAME PROGRAM ARGUMENT...
    "${@:2}" > "$directory/$1.out" 2> "$directory/$1.err" &
}

# Plays the linkbar once, then the other job again and again; ends with the program that it waits for.
station() { # CELL
    trap 'kill "$player" 2>/dev/null; exit 0' TERM
    local job=linkbar
    while true; do
        "$programs/rcs-neighbour" workstation --network "unix:$directory/$1-station.sock" "$job" &
        player=$!
        wait "$player" || sleep 1
        job=$directory/to-and-fro.job
    done
}

start router "$gateway" router "tls/127.0.0.1:$router" --keys "$directory/keys" --name router \
    --cells "${cells[@]}" --monitors mes
port=$router
for cell in "${cells[@]}"; do
    endpoint=tls/127.0.0.1:$((++port))
    start "$cell-run" "$programs/rcs-run" --clock real --network "unix:$directory/$cell.sock" --outside workstation \
        --log none --shared-memory off
    start "$cell-serve" "$gateway" serve "$cell" "$endpoint" --run "unix:$directory/$cell.sock" \
        --router "tls/127.0.0.1:$router" --keys "$directory/keys" --allow "workstation=hwsc-$cell" monitor=mes,router
    start "$cell-connect" "$gateway" connect "$cell@$endpoint" workstation "unix:$directory/$cell-station.sock" \
        --keys "$directory/keys" --name "hwsc-$cell"
    station "$cell" > "$directory/$cell-station.out" 2> "$directory/$cell-station.err" &
done
echo "five cells run; watch them: $gateway monitor tls/127.0.0.1:$router --keys $directory/keys --name mes"
wait
