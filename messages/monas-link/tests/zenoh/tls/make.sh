#!/usr/bin/env bash
# Creates the certificates of the tests: an authority, three hosts signed by it, an expired one, and
# one signed by another authority. They are valid for a hundred years.
set -euo pipefail
cd "$(dirname "$0")"

extensions() { printf 'basicConstraints=CA:false\nsubjectAltName=DNS:localhost,IP:127.0.0.1\nextendedKeyUsage=serverAuth,clientAuth\n'; }

key() { openssl ecparam -name prime256v1 -genkey -noout | openssl pkcs8 -topk8 -nocrypt -out "$1.key"; }

authority() {
    key "$1"
    openssl req -x509 -new -key "$1.key" -subj "/CN=$1" -days 36500 -out "$1.pem" -addext basicConstraints=critical,CA:true
}

host() {
    key "$1"
    openssl req -new -key "$1.key" -subj "/CN=$1" |
        openssl x509 -req -CA "$2.pem" -CAkey "$2.key" -CAcreateserial -days 36500 -out "$1.pem" -extfile <(extensions)
}

# Valid in January 2020 only.
expired() {
    key "$1"
    openssl req -new -key "$1.key" -subj "/CN=robot_4" -out request.csr
    printf '[ca]\ndefault_ca=own\n[own]\ndatabase=index.txt\nserial=serial\nnew_certs_dir=.\ndefault_md=sha256\npolicy=any\n[any]\ncommonName=supplied\n' >ca.conf
    : >index.txt
    : >index.txt.attr
    echo 01 >serial
    openssl ca -batch -notext -config ca.conf -in request.csr -out "$1.pem" -cert "$2.pem" -keyfile "$2.key" \
        -startdate 20200101000000Z -enddate 20200131000000Z -extfile <(extensions)
    rm -f request.csr ca.conf index.txt* serial* [0-9A-F]*.pem
}

authority team
authority strangers
host robot_1 team
host robot_2 team
host laptop team
expired expired team
host stranger strangers
rm -f ./*.srl team.key strangers.key
