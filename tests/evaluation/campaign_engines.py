# SPDX-License-Identifier: Apache-2.0
"""The job files of campaigns/ on GNU parallel, ssh to this machine and a Slurm of one node, each against one run. An
engine that is not installed, or may not be started here, is skipped, and said so."""
import getpass, os, shutil, socket, subprocess, sys, tempfile, time

EVALUATION = ["tissue", "--scenario", "N0", "--runs", "2", "--arm-runs", "0", "--world-runs", "0"]
faults, skipped, shown = [], [], []


def run(words, **more):
    return subprocess.run(words, capture_output=True, text=True, timeout=120, **more)


def check(engine, binary, folder, whole, again):
    """Tables as of one run; without a file its cells are named; `again` does that shard once more."""
    files = [f"{folder}/{shard}.cells" for shard in range(1, 5)]
    merge = lambda: run([binary, "evaluate", "merge", "--json", "--quiet", *[file for file in files if os.path.exists(file)]])
    if merge().stdout != whole:
        return faults.append(f"{engine}: other tables than one run: {merge().stderr}")
    full = next(file for file in files if '"cell"' in open(file, encoding="utf-8").read())
    os.remove(full)
    lost = merge()
    if lost.returncode != 2 or "N0 " not in lost.stderr or lost.stdout:
        return faults.append(f"{engine}: the lost cells are not named: {lost.stderr}")
    again(files.index(full) + 1)
    if merge().stdout != whole:
        return faults.append(f"{engine}: other tables after a lost shard was done again")
    shown.append(engine)


def by_parallel(binary, root, folder, whole):
    if not shutil.which("parallel"):
        return skipped.append("GNU parallel: not installed")
    job = lambda *_: run([f"{root}/campaigns/on_this_machine.sh", f"{folder}/parallel", "4", *EVALUATION])
    job()
    check("GNU parallel", binary, f"{folder}/parallel", whole, job)


def by_ssh(binary, root, folder, whole):
    if not os.path.exists("/usr/sbin/sshd") or not shutil.which("ssh"):
        return skipped.append("ssh: not installed")
    if os.getuid() == 0:
        os.makedirs("/run/sshd", exist_ok=True)
    for key in ("host", "own"):
        run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", f"{folder}/{key}"])
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen(["/usr/sbin/sshd", "-D", "-f", "/dev/null", "-p", str(port), "-h", f"{folder}/host", *[
        word for option in ("ListenAddress=127.0.0.1", f"AuthorizedKeysFile={folder}/own.pub", "StrictModes=no",
                            "PermitRootLogin=yes", "UsePAM=no", "PidFile=none") for word in ("-o", option)]],
        stderr=subprocess.DEVNULL)
    try:
        time.sleep(1)
        hosts = f"{folder}/hosts"
        with open(hosts, "w", encoding="utf-8") as file:
            file.write(f"{getpass.getuser()}@127.0.0.1\n" * 2)
        os.environ["SSH_OPTIONS"] = f"-p {port} -i {folder}/own -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null"
        name = f"ssh-{os.getpid()}"
        job = lambda *_: run([f"{root}/campaigns/by_ssh.sh", hosts, f"{folder}/{name}", "4", *EVALUATION])
        done = job()
        if "1.cells" not in os.listdir(f"{folder}/{name}"):
            return skipped.append(f"ssh: nobody comes in here: {done.stderr[-200:]}")
        check("ssh", binary, f"{folder}/{name}", whole, job)
        shutil.rmtree(os.path.expanduser(f"~/tuina-campaign/{name}"), ignore_errors=True)
    finally:
        server.terminate()
        server.wait()


def by_slurm(binary, root, folder, whole):
    if not all(shutil.which(program, path="/usr/sbin:/usr/bin") for program in ("slurmctld", "slurmd", "munged", "sbatch")):
        return skipped.append("Slurm: not installed")
    if os.getuid() != 0:
        return skipped.append("Slurm: its node wants to be started by root")
    slurm, host = f"{folder}/slurm", socket.gethostname()
    for part in ("controller", "node", "munge"):
        os.makedirs(f"{slurm}/{part}")
    with open(f"{slurm}/munge/key", "wb") as file:
        file.write(os.urandom(128))
    for path, mode in ((f"{slurm}/munge", 0o755), (f"{slurm}/munge/key", 0o600)):
        os.chmod(path, mode)
    door = f"{slurm}/munge/socket"
    with open(f"{slurm}/slurm.conf", "w", encoding="utf-8") as file:
        file.write(f"""ClusterName=one
SlurmctldHost={host}
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthInfo=socket={door}
StateSaveLocation={slurm}/controller
SlurmdSpoolDir={slurm}/node
SlurmctldPidFile={slurm}/controller.pid
SlurmdPidFile={slurm}/node.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
NodeName={host} CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES State=UP
""")
    os.environ["SLURM_CONF"] = f"{slurm}/slurm.conf"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    daemons = []
    try:
        for words in (["munged", "--foreground", "--force", f"--key-file={slurm}/munge/key", f"--socket={door}",
                       f"--pid-file={slurm}/munge/pid", f"--log-file={slurm}/munge/log", f"--seed-file={slurm}/munge/seed"],
                      ["slurmctld", "-D"], ["slurmd", "-D"]):
            daemons.append(subprocess.Popen(words, **quiet))
            time.sleep(2)
        if any(daemon.poll() is not None for daemon in daemons):
            return skipped.append("Slurm: does not start here")
        job = lambda shards: run(["sbatch", "--wait", f"--array={shards}", f"{root}/campaigns/slurm_array.sh",
                                  f"{folder}/array", "4", *EVALUATION])
        done = job("1-4")
        if done.returncode != 0:
            return skipped.append(f"Slurm: takes no job here: {done.stderr}")
        check("Slurm", binary, f"{folder}/array", whole, job)
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
            daemon.wait()


def main(binary, root):
    os.environ["TUINA"] = binary
    os.environ["PATH"] += ":/usr/sbin"
    with tempfile.TemporaryDirectory() as folder:
        whole = run([binary, "evaluate", *EVALUATION, "--json", "--quiet"]).stdout
        for engine in (by_parallel, by_ssh, by_slurm):
            engine(binary, root, folder, whole)
    print(f"as one run: {', '.join(shown) or 'none'}", *[f"skipped: {why}" for why in skipped], *faults, sep="\n")
    return 1 if faults else 77 if not shown else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
