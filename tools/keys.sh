#!/bin/sh
# Makes keys and certificates for a cell and for those that connect to its gateway, with openssl.
#
#   tools/keys.sh DIR CELL ADDRESS [NAME]...
#
# DIR      directory for the files, created if missing; existing files stay
# CELL     name of the cell, and of the certificate of its gateway
# ADDRESS  IP address at which the gateway listens
# NAME     common name of a neighbour, an operator, a monitor or a router (default: workstation data-system pedestal
#          vision operator monitor); NAME@ADDRESS for a router, which others connect to
#
# Give each machine ca.pem, NAME.pem and NAME.key, and nothing else. Keep ca.key off the machines of the cell: whoever
# has it can make any certificate. RCS_KEYS_DAYS sets the validity (825 days). To renew a certificate, delete its two
# files and call this again.
set -eu

usage() {
    sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p;}' "$0" >&2
    exit 2
}

check() { # NAME
    case $1 in
    '' | .* | *[!A-Za-z0-9._-]*) echo "keys.sh: expected a name of letters, digits, -, _ and ., found '$1'" >&2; exit 2 ;;
    ca) echo "keys.sh: ca is the name of the authority: choose another name" >&2; exit 2 ;;
    esac
}

# A new private key, readable by its owner only.
new_key() { # NAME
    openssl ecparam -name prime256v1 -genkey -noout | openssl pkcs8 -topk8 -nocrypt -out "$1.new"
}

authority() {
    [ -e ca.key ] && [ -e ca.pem ] && return
    new_key ca.key
    openssl req -x509 -key ca.key.new -days 3650 -subj "/CN=authority of $cell" -out ca.pem \
        -addext basicConstraints=critical,CA:true -addext keyUsage=critical,keyCertSign,cRLSign
    mv ca.key.new ca.key
}

sign() { # NAME PURPOSES SUBJECT-ALT-NAME
    [ -e "$1.key" ] && [ -e "$1.pem" ] && return
    new_key "$1.key"
    openssl req -new -key "$1.key.new" -subj "/CN=$1" -out "$1.csr"
    printf '%s\n' "basicConstraints=critical,CA:false" "keyUsage=critical,digitalSignature" "extendedKeyUsage=$2" \
        "subjectAltName=$3" "authorityKeyIdentifier=keyid" "subjectKeyIdentifier=hash" >"$1.ext"
    openssl x509 -req -in "$1.csr" -CA ca.pem -CAkey ca.key -set_serial "0x$(openssl rand -hex 16)" \
        -days "${RCS_KEYS_DAYS:-825}" -extfile "$1.ext" -out "$1.pem" 2>/dev/null
    rm -f "$1.csr" "$1.ext"
    mv "$1.key.new" "$1.key"
    echo "made $1.pem and $1.key"
}

[ $# -ge 3 ] || usage
directory=$1 cell=$2 address=$3
shift 3
check "$cell"
[ $# -gt 0 ] || set -- workstation data-system pedestal vision operator monitor
for name; do check "${name%%@*}"; done

umask 077
mkdir -p "$directory"
cd "$directory"
authority
# The gateway of a cell listens, and it connects to a router.
sign "$cell" serverAuth,clientAuth "IP:$address"
for name; do
    case $name in
    *@*) sign "${name%%@*}" serverAuth,clientAuth "IP:${name#*@}" ;;
    *) sign "$name" clientAuth "DNS:$name" ;;
    esac
done
