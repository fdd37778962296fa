#!/bin/sh
# Takes the link between a controller and an emulated coupler down, in two network namespaces, and prints the greatest
# age of an image that the coupler carried out. Needs root and iproute2.
#   link_down.sh PROGRAM TIMES SECONDS...       PROGRAM is the example `coupler` of crates/executive
# With NEIGHBOUR=dynamic the controller has to ask for the coupler's hardware address after each loss of the link.
set -eu
program=$1 times=$2
shift 2
folder=$(mktemp -d)
cleanup() {
    kill $processes 2>/dev/null || true
    ip netns delete rcs-controller
    ip netns delete rcs-coupler
    rm -r "$folder"
}
processes=
ip netns add rcs-controller
ip netns add rcs-coupler
trap cleanup EXIT
trap 'exit 1' INT TERM
ip link add rcs0 netns rcs-controller type veth peer name rcs1 netns rcs-coupler
ip -n rcs-controller address add 10.99.0.1/24 dev rcs0
ip -n rcs-coupler address add 10.99.0.2/24 dev rcs1
ip -n rcs-controller link set rcs0 up
ip -n rcs-coupler link set rcs1 up
if [ "${NEIGHBOUR:-static}" = static ]; then
    address=$(ip netns exec rcs-coupler cat /sys/class/net/rcs1/address)
    ip -n rcs-controller neighbour replace 10.99.0.2 lladdr "$address" nud permanent dev rcs0
fi
ip netns exec rcs-coupler "$program" station 10.99.0.2:1502 >"$folder/station" &
processes="$processes $!"
sleep 1
ip netns exec rcs-controller "$program" controller 10.99.0.2:1502 36000 >"$folder/controller" &
processes="$processes $!"
sleep 2
for seconds in "$@"; do
    for _ in $(seq "$times"); do
        ip -n rcs-coupler link set rcs1 down
        sleep "$seconds"
        ip -n rcs-coupler link set rcs1 up
        sleep 1.5
    done
    echo "down $seconds s, $times times: $(tail -n 1 "$folder/station")"
done
echo "trips: $(grep -c Tripped "$folder/controller" || true)"
