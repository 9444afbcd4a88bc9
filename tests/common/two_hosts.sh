#!/usr/bin/env bash
# two_hosts.sh COMMAND...: runs a command on 2 + 2 ranks of two hosts, `one` and `two`, by MPICH's launcher. The hosts are namespaces of
# this machine, each with a network and a name of its own, joined by a cable. Exit code 77 where the machine allows no such thing.
set -u

if [ "${TWO_HOSTS:-}" != inside ]; then
    own=(unshare --mount --net)
    [ "$(id -u)" = 0 ] || own=(unshare --user --map-root-user --mount --net)
    command -v mpiexec.mpich ip nsenter unshare >/dev/null && "${own[@]}" true 2>/dev/null || exit 77
    TWO_HOSTS=inside exec "${own[@]}" -- bash "$0" "$@"
fi

scratch=$(mktemp -d)
trap 'kill $one $two; rm -rf "$scratch"' EXIT
unshare --net --uts sleep 600 & one=$!
unshare --net --uts sleep 600 & two=$!
for _ in $(seq 100); do # until both are in namespaces of their own
    here=$(readlink /proc/self/ns/uts)
    [ "$(readlink /proc/$one/ns/uts)" != "$here" ] && [ "$(readlink /proc/$two/ns/uts)" != "$here" ] && break
    sleep 0.02
done
on() { # on HOST COMMAND...
    local host=$1
    shift
    nsenter --target "$host" --net --uts "$@"
}
cable() { # cable HOST NAME ADDRESS END
    ip link set "$4" netns "$1" && on "$1" hostname "$2" && on "$1" ip link set lo up &&
        on "$1" ip addr add "$3/24" dev "$4" && on "$1" ip link set "$4" up
}
{ ip link add left type veth peer name right && cable $one one 10.77.0.1 left && cable $two two 10.77.0.2 right; } \
    2>/dev/null || exit 77

# What MPICH's launcher calls in place of ssh: -x HOST COMMAND...
cat >"$scratch/launch" <<END
#!/bin/sh
case \$2 in 10.77.0.1) host=$one ;; *) host=$two ;; esac
shift 2
exec nsenter --target \$host --net --uts sh -c "\$*"
END
chmod +x "$scratch/launch"
by() { on $one timeout 120 mpiexec.mpich -launcher ssh -launcher-exec "$scratch/launch" -hosts 10.77.0.1:2,10.77.0.2:2 -n 4 "$@"; }
[ "$(by hostname 2>/dev/null | sort | tr '\n' ' ')" = "one one two two " ] || exit 77
by "$@"
