# A Slurm cluster of two nodes on this machine, for scripts that source this file: everything listens on loopback, and lies in the
# folder $work. Debian's packages are installed where they are missing.

packages="slurm-wlm munge"

install_slurm() {
    PATH="$PATH:/usr/sbin"
    type sbatch slurmctld slurmd munged > /dev/null 2>&1 || install_packages $packages || {
        echo "install $packages first: sweeps are tested on a Slurm, and this user may not install packages" >&2
        return 1
    }
}

# A port that nobody listens to.
free_port() {
    local port
    while :; do
        port=$((20000 + RANDOM % 12000))
        (exec 3<> "/dev/tcp/127.0.0.1/$port") 2> /dev/null || break
    done
    echo "$port"
}

# Nodes are given up after 6 seconds without an answer, and tasks are kept from a second start for 5, not for two minutes.
configure_cluster() {
    local node
    export SLURM_CONF="$work/slurm.conf"
    mkdir -p "$work/munge" "$work/state"
    # munged asks for these.
    chmod 755 "$work" "$work/munge"
    head -c 128 /dev/urandom > "$work/munge/key"
    chmod 600 "$work/munge/key"
    cat > "$SLURM_CONF" <<END
ClusterName=jointsweep
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/linear
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2
ReturnToService=2
SlurmdTimeout=6
KillWait=2
NodeName=one NodeHostname=localhost NodeAddr=127.0.0.1 Port=$(free_port) CPUs=1
NodeName=two NodeHostname=localhost NodeAddr=127.0.0.1 Port=$(free_port) CPUs=1
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP
END
    for node in one two; do
        mkdir -p "$work/spool-$node"
    done
}

start_munged() {
    munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
        --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" > /dev/null 2>&1 &
    disown
}

start_controller() {
    slurmctld -D -i "$@" > "$work/slurmctld.out" 2>&1 &
    controller=$!
    disown
}

start_node() { # name
    slurmd -D -N "$1" > "$work/slurmd-$1.out" 2>&1 &
    disown
}

# Processes, by their numbers, that have a file open whose path begins so.
processes_at() { # path
    # A process that ends meanwhile is an error of find's.
    { find /proc/[0-9]*/fd -maxdepth 1 -lname "$1*" 2> /dev/null || true; } | cut -d / -f 3 | sort -un
}

# As when its machine loses power: nothing of it has the time to tell the controller, so what watches a task goes before the task.
kill_node() { # name
    local daemons tasks
    daemons=$(processes_at "$work/slurmd-$1.log")
    tasks=$(processes_at "$work/spool-$1/")
    kill -9 $daemons $tasks $(children_of $tasks) 2> /dev/null || true
}

children_of() { # processes
    local process child
    for process in "$@"; do
        for child in $(cat "/proc/$process/task/$process/children" 2> /dev/null); do
            echo "$child"
            children_of "$child"
        done
    done
}

stop_cluster() {
    local left
    scancel --user "$(id -un)" 2> /dev/null || true
    for _ in 1 2 3; do
        left=$(processes_at "$work/")
        [ -z "$left" ] && return
        kill -9 $left 2> /dev/null || true
        sleep 0.2
    done
}
