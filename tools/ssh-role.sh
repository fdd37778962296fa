#!/bin/sh
# Connects a neighbour on an ssh connection to the socket of a run, in one role (docs/several-machines.md "Without Zenoh").
#
#   tools/ssh-role.sh ROLE SOCKET
#
# Use it as a forced command in authorized_keys. ROLE is workstation, data-system, pedestal, vision or operator; a hello of another role
# ends the connection. Needs socat.
set -eu
case ${1-} in
workstation) number=1 ;;
data-system) number=2 ;;
pedestal) number=3 ;;
vision) number=4 ;;
operator) number=5 ;;
*) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p;}' "$0" >&2; exit 2 ;;
esac
{
    # The hello of docs/neighbours.md "On the line": RCS2, version 3, number of the role.
    hello=$(dd bs=1 count=8 2>/dev/null | od -An -tx1 | tr -d ' \n')
    if [ "$hello" != "5243533203000${number}00" ]; then
        echo "ssh-role.sh: a hello of the role $1 was expected, found $hello" >&2
        exit 1
    fi
    printf "RCS2\\003\\000\\00$number\\000"
    exec cat
} | socat - "UNIX-CONNECT:$2"
