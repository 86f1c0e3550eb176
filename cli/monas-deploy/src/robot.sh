# Executed by the robot's `sh` for `monas deploy`, with a task, the folder of Monas on the robot, and
# the arguments of the task:
#
#   look FOLDER                               lists the releases
#   receive FOLDER RELEASE                    unpacks a release, a tar archive on standard input
#   check FOLDER RELEASE PROGRAM              verifies its hashes and starts the program once
#   run FOLDER RELEASE UNIT SERVICE SECONDS   makes it current; restores the previous
#                                             one if it does not keep running for SECONDS
#
# A release is a folder below `releases`; `current` points to one. Lines on standard output that
# start with `@` are parsed by the command, all others are for the user.
# Exit codes: 21 hashes differ, 22 the program does not start, 23 it stopped and the previous release
# was restored, 24 it stopped and nothing runs.
set -eu
task=$1
mkdir -p "$2/releases"
cd "$2"
folder=$(pwd -P)

current() {
    [ ! -L current ] || basename "$(readlink current)"
}

point_to() {
    ln -sfn "releases/$1" current.new
    mv -Tf current.new current 2>/dev/null || { rm -f current.new; ln -sfn "releases/$1" current; }
}

# The available kind of service.
kind_of() {
    case $1 in
    auto) if systemctl --user show-environment >/dev/null 2>&1; then echo systemd; else echo script; fi ;;
    *) echo "$1" ;;
    esac
}

start_systemd() {
    units="${XDG_CONFIG_HOME:-$HOME/.config}/systemd/user"
    mkdir -p "$units"
    # As a quoted word of systemd: `\` and `"` are escaped by `\`, `%` begins a specifier. Systemd
    # starts no program whose name has a quote or a backslash, but says so.
    start=$(printf '%s\n' "$folder/current/start" | sed 's/[\"]/\\&/g; s/%/%%/g')
    cat >"$units/$unit.service" <<UNIT
[Unit]
Description=Monas, $unit

[Service]
ExecStart="$start"
Restart=on-failure
RestartSec=1

[Install]
WantedBy=default.target
UNIT
    systemctl --user daemon-reload
    systemctl --user enable "$unit.service" 2>/dev/null
    systemctl --user restart "$unit.service"
}

# A script that starts and stops the current release, for robots without a service manager; called
# by the robot's startup scripts.
write_script() {
    cat >service.new <<'SCRIPT'
#!/bin/sh
# Starts and stops the current release of Monas: service start|stop|status
cd "$(dirname "$0")" || exit 1
# The identity of a process: its number, when it started, and in which boot. After its end, or after
# the next boot, another process may have the number.
identity() {
    boot='' started=''
    if [ -d /proc/self ]; then
        # The second field is the name, which may contain anything; the start is field 22.
        started=$(sed 's/^.*) //' "/proc/$1/stat" 2>/dev/null | cut -d ' ' -f 20)
        boot=$(cat /proc/sys/kernel/random/boot_id 2>/dev/null)
    else
        started=$(ps -o lstart= -p "$1" 2>/dev/null)
    fi
    [ -z "$started" ] || echo "$1 $started $boot"
}
# Whether the process that was started runs. A zombie process stays visible until reaped, which some
# init processes never do.
runs() {
    [ -f service.pid ] || return 1
    known=$(cat service.pid)
    process=${known%% *}
    case $process in
    '' | *[!0-9]*) return 1 ;;
    esac
    [ "$(identity "$process")" = "$known" ] && ! grep -qs '^State:[[:space:]]*Z' "/proc/$process/status"
}
# The output of the last runs stays in service.log.1 and so on.
keep_log() {
    for number in 4 3 2 1; do
        [ ! -f "service.log.$number" ] || mv -f "service.log.$number" "service.log.$((number + 1))"
    done
    [ ! -f service.log ] || mv -f service.log service.log.1
}
case ${1:-} in
start)
    runs && exit 0
    keep_log
    if command -v setsid >/dev/null; then
        setsid ./current/start >service.log 2>&1 </dev/null &
    else
        nohup ./current/start >service.log 2>&1 </dev/null &
    fi
    identity $! >service.pid.new
    mv -f service.pid.new service.pid
    ;;
stop)
    if runs; then
        kill "$process"
        waited=0
        while runs && [ "$waited" -lt 10 ]; do
            sleep 1
            waited=$((waited + 1))
        done
        ! runs || kill -9 "$process"
    fi
    rm -f service.pid
    ;;
status) runs ;;
*)
    echo "usage: service start|stop|status" >&2
    exit 2
    ;;
esac
SCRIPT
    chmod 755 service.new
    mv -f service.new service
}

start() {
    case $kind in
    systemd) start_systemd ;;
    script)
        write_script
        ./service stop
        ./service start
        ;;
    esac
}

goes_on() {
    case $kind in
    systemd) systemctl --user is-active --quiet "$unit.service" ;;
    script) ./service status ;;
    *) true ;;
    esac
}

goes_on_for() {
    waited=0
    while [ "$waited" -lt "$1" ]; do
        sleep 1
        waited=$((waited + 1))
        goes_on || return 1
    done
}

stop() {
    case $kind in
    systemd) systemctl --user stop "$unit.service" || true ;;
    script) ./service stop ;;
    esac
}

last_words() {
    case $kind in
    systemd) journalctl --user -u "$unit.service" -n 20 --no-pager 2>/dev/null || true ;;
    script) tail -n 20 service.log 2>/dev/null || true ;;
    esac
}

# Keeps the three newest releases, the current one and the previous one.
tidy() {
    ls -1t releases | tail -n +4 | while read -r old; do
        case $old in
        "$(current)" | "$(cat previous 2>/dev/null || true)") ;;
        *) rm -rf "releases/$old" ;;
        esac
    done
}

case $task in
look)
    echo "@machine $(uname -s) $(uname -m)"
    echo "@current $(current)"
    echo "@previous $(cat previous 2>/dev/null || true)"
    for release in releases/*; do
        case $release in
        *.part | 'releases/*') ;;
        *) echo "@release $(basename "$release")" ;;
        esac
    done
    ;;
receive)
    rm -rf "releases/$3.part"
    mkdir "releases/$3.part"
    tar -xf - -C "releases/$3.part"
    ;;
check)
    cd "releases/$3.part"
    if ! sha256sum -c SHA256SUMS >../../check.log 2>&1; then
        grep -v ': OK$' ../../check.log >&2
        cd ../..
        rm -rf "releases/$3.part"
        exit 21
    fi
    if ! "./bin/$4" --version >../../check.log 2>&1; then
        cat ../../check.log >&2
        cd ../..
        rm -rf "releases/$3.part"
        exit 22
    fi
    cd ../..
    rm -rf "releases/$3"
    mv "releases/$3.part" "releases/$3"
    ;;
run)
    release=$3 unit=$4 kind=$(kind_of "$5")
    before=$(current)
    # The release to restore on failure.
    if [ "$before" = "$release" ]; then
        back=$(cat previous 2>/dev/null || true)
    else
        back=$before
    fi
    [ -d "releases/$release" ] || { echo "there is no release $release" >&2; exit 1; }
    echo "@service $kind"
    point_to "$release"
    if start && goes_on_for "$6"; then
        [ "$before" = "$release" ] || [ -z "$before" ] || echo "$before" >previous
        tidy
        exit 0
    fi
    last_words >&2
    stop
    if [ -z "$back" ] || [ ! -d "releases/$back" ]; then
        rm -f current
        exit 24
    fi
    point_to "$back"
    start || exit 24
    exit 23
    ;;
*)
    echo "no task $task" >&2
    exit 2
    ;;
esac
