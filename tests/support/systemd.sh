#!/bin/bash
# Boots a real systemd that knows nothing but the units of the chain, in namespaces of its own: it sees this machine's
# programs, but has its own processes, network, cgroups, /etc, /run, /tmp, /dev/shm and /var/lib. Needs root and cgroup2.
#
#   systemd.sh boot BINARY DEPLOY CONFIG     boots, with the units of DEPLOY, and stays until it is powered off;
#                                            prints the pid of that systemd; 77 if this machine cannot do it
#   systemd.sh in PID COMMAND…               runs a command inside, for example systemctl status 'radar-chain-*'
#   systemd.sh off PID                       powers it off; `boot` then ends and leaves nothing
#
# Nothing is enabled at first: systemd.sh in PID systemctl enable --now radar-chain.target
set -eu

cannot() {
    echo "no systemd can be booted here: $*" >&2
    exit 77
}

boot() {
    ls "$1" "$2/systemd" "$3" >/dev/null || exit 2
    [ "$(id -u)" = 0 ] || cannot "this is not root"
    [ -x /lib/systemd/systemd ] || cannot "/lib/systemd/systemd is missing"
    local hierarchy=/sys/fs/cgroup
    [ -d $hierarchy/unified ] && hierarchy=$hierarchy/unified
    [ -e $hierarchy/cgroup.procs ] || cannot "there is no cgroup2 hierarchy"
    local group scratch home
    scratch=$(mktemp -d)
    group=$hierarchy/radar-chain-test-$$
    home=$hierarchy$(sed -n 's/^0:://p' /proc/self/cgroup)
    mkdir "$group" 2>/dev/null || cannot "no cgroup can be made in $hierarchy"
    echo $$ >"$group/cgroup.procs"
    unshare --mount --pid --fork --kill-child --uts --ipc --net --cgroup --propagation private \
        bash "$0" inside "$scratch" "$@" &
    local unshared=$!
    # A test that gives up ends this shell; what it has booted ends with it.
    trap 'kill -KILL $unshared 2>/dev/null' TERM INT
    while [ ! -e "$scratch/booting" ] && kill -0 $unshared 2>/dev/null; do sleep 0.05; done
    echo $(cat "/proc/$unshared/task/$unshared/children" 2>/dev/null)
    local code=0
    wait $unshared || code=$?
    echo $$ >"$home/cgroup.procs"
    for _ in $(seq 100); do # processes of the namespace may still be dying
        find "$group" -depth -type d -exec rmdir {} + 2>/dev/null && break
        sleep 0.05
    done
    local booted=0
    [ -e "$scratch/booting" ] && booted=1
    rm -rf "$scratch"
    [ $booted = 1 ] || cannot "the namespaces were refused ($code)"
}

# In the new namespaces, as their first process.
inside() {
    local scratch=$1 binary=$2 deploy=$3 config=$4
    mount -t proc proc /proc
    mount --bind /proc/sys /proc/sys && mount -o remount,bind,ro /proc/sys # the kernel is everybody's
    umount -R /sys/fs/cgroup
    mount -t cgroup2 cgroup2 /sys/fs/cgroup

    local files=$scratch/files # a filesystem that is gone with the namespace
    mkdir "$files" && mount -t tmpfs tmpfs "$files"
    mkdir "$files"/{bin,etc,work}
    cp "$binary" "$files/bin/radar-chain"
    cp -r "$deploy" "$files/deploy"
    cp "$config" "$files/chain.toml"
    mount -t overlay overlay -o "lowerdir=/etc,upperdir=$files/etc,workdir=$files/work" /etc
    mount --bind "$files/bin" /usr/local/bin
    mkdir /etc/radar-chain
    cp "$files/chain.toml" /etc/radar-chain/
    systemd-sysusers "$files/deploy/systemd/sysusers.conf" 2>/dev/null
    # Of all units only those of the chain and the journal: nothing of this machine is started.
    mkdir -p /etc/systemd/radar-chain-test /etc/systemd/journald.conf.d
    mount -t tmpfs -o mode=0755 tmpfs /etc/systemd/system
    cp -r "$files"/deploy/systemd/{*.service,*.target,*.d} /etc/systemd/system/
    cp /lib/systemd/system/systemd-journald{.service,.socket,-dev-log.socket} /etc/systemd/radar-chain-test/
    for unit in sysinit basic multi-user shutdown local-fs; do
        printf '[Unit]\nDefaultDependencies=no\n' >/etc/systemd/radar-chain-test/$unit.target
    done
    printf '[Unit]\nRequires=systemd-journald.service\nAfter=systemd-journald.service\n' \
        >/etc/systemd/radar-chain-test/test.target
    printf '[Journal]\nStorage=volatile\nReadKMsg=no\n' >/etc/systemd/journald.conf.d/radar-chain-test.conf

    : >"$scratch/booting"
    mount -t tmpfs -o mode=0755 tmpfs /run
    mount -t tmpfs -o mode=0755 tmpfs /var/lib
    mount -t tmpfs -o mode=1777 tmpfs /dev/shm
    mount -t tmpfs -o mode=1777 tmpfs /tmp
    exec env -i PATH="$PATH" container=test SYSTEMD_GENERATOR_PATH=/nowhere \
        SYSTEMD_UNIT_PATH=/etc/systemd/system:/etc/systemd/radar-chain-test \
        /lib/systemd/systemd --system --unit=test.target --log-target=journal --show-status=no
}

in_namespaces() {
    local pid=$1
    shift
    exec nsenter --target "$pid" --mount --pid --uts --ipc --net --cgroup "$@"
}

case ${1-} in
boot | inside) "$@" ;;
in) shift && in_namespaces "$@" ;;
off) in_namespaces "$2" systemctl --force --force poweroff ;;
*) sed -n '2,10s/^# \?//p' "$0" >&2 && exit 2 ;;
esac
