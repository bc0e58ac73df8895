#!/usr/bin/python3
"""A survey and a pattern search by workers of two nodes of Slurm, of two ranks of Open MPI and of GNU
parallel: equal bytes, workers that are lost, evaluations a second.

  cluster.py TOOL BENCH-SEARCH ROOT

Starts munged, slurmctld and two slurmd on this machine, in a folder of its own, and ends them. Needs
slurm-wlm, munge, openmpi-bin and parallel, and root; without them it is skipped.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

tool, bench, root = (os.path.abspath(path) for path in sys.argv[1:])
knit = os.path.join(root, 'pipelines/model-knit.json')
drag = os.path.join(root, 'tests/data/take_drag')
cluster = os.path.join(root, 'pipelines/cluster')
SKIP = 77
CONFIGURATION = '''ClusterName=cloth
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SlurmdTimeout=10
ReturnToService=2
MinJobAge=2
NodeName=one NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1
NodeName=two NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP
'''
faults = []
daemons = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def run(folder, *arguments, timeout=280):
    return subprocess.run(arguments, cwd=folder, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL)


def wait_until(true, seconds=60):
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return true()


def free_ports(n):
    sockets = [socket.socket() for _ in range(n)]
    for one in sockets:
        one.bind(('127.0.0.1', 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def start_daemon(*words, **more):
    daemons.append(subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more))
    return daemons[-1]


def start_munge(folder):
    place = os.path.join(folder, 'munge')
    os.mkdir(place, 0o711)
    with open(os.path.join(place, 'key'), 'wb') as file:
        file.write(os.urandom(128))
    os.chmod(os.path.join(place, 'key'), 0o400)
    user = pwd.getpwnam('munge')
    for path in place, os.path.join(place, 'key'):
        os.chown(path, user.pw_uid, user.pw_gid)
    start_daemon('munged', '--foreground', '--key-file=%s/key' % place, '--socket=%s/socket' % place, '--pid-file=%s/pid' % place,
                 '--seed-file=%s/seed' % place, user=user.pw_uid, group=user.pw_gid, extra_groups=[])
    return wait_until(lambda: os.path.exists(os.path.join(place, 'socket')), 20)


def start_slurm(folder):
    os.chmod(folder, 0o755)
    os.mkdir(os.path.join(folder, 'state'))
    path = os.path.join(folder, 'slurm.conf')
    with open(path, 'w', encoding='ascii') as file:
        file.write(CONFIGURATION.format(host=socket.gethostname(), folder=folder, ports=free_ports(3)))
    os.environ['SLURM_CONF'] = path
    if not start_munge(folder):
        return False
    start_daemon('slurmctld', '-D', '-f', path)
    for node in 'one', 'two':
        start_daemon('slurmd', '-D', '-N', node, '-f', path)
    return wait_until(lambda: run(folder, 'sinfo', '--noheader', '-N', '-o', '%N %t').stdout.split()
                      == ['one', 'idle', 'two', 'idle'], 60)


def survey(output, *more):
    return (tool, 'survey', 'list.txt', '--model', knit, '--effects', 'air_drag,wind', '--output', output, *more)


def manage(folder, output):
    return subprocess.Popen(survey(output, '--workers', '0'), cwd=folder, text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, stdin=subprocess.DEVNULL)


def read(folder, output):
    with open(os.path.join(folder, output, 'survey.json'), 'rb') as file:
        return file.read()


def finish(manager, folder, what):
    out, error = manager.communicate(timeout=400)
    expect(manager.returncode == 0 and read(folder, what) == read(folder, 'alone'), '%s: equal bytes %s' % (what, error[-200:]))
    return out


def names(folder, name):
    path = os.path.join(folder, name)
    return [entry for entry in os.listdir(path) if entry[0] != '.'] if os.path.isdir(path) else []


def nodes_of(folder, job):
    """Which nodes an array's tasks run on."""
    return sorted(run(folder, 'squeue', '--noheader', '--job', job, '--states=R', '-o', '%N').stdout.split())


def slurm(folder):
    job = run(folder, os.path.join(cluster, 'slurm.sh'), 'slurm/spool', '2').stdout.strip()
    expect(re.fullmatch(r'\d+', job), 'job ' + job)
    expect(wait_until(lambda: nodes_of(folder, job) == ['one', 'two']), 'workers on both nodes, before their manager')
    finish(manage(folder, 'slurm'), folder, 'slurm')
    expect(wait_until(lambda: not nodes_of(folder, job)), 'they end by themselves')
    expect(len(names(folder, 'slurm/spool/logs')) == 2, 'logs')


def lost(folder):
    """A worker is killed at its job, then Slurm kills the others; the takes go to new ones."""
    manager = manage(folder, 'lost')
    job = run(folder, os.path.join(cluster, 'slurm.sh'), 'lost/spool', '2').stdout.strip()
    expect(wait_until(lambda: len(names(folder, 'lost/spool/running')) == 2), 'two takes are diagnosed')
    held = sorted(names(folder, 'lost/spool/running'))
    victim = held[0].split('@')[1]
    before = time.monotonic()
    os.kill(int(victim.split('-')[1]), signal.SIGKILL)
    expect(wait_until(lambda: not any(victim in name for name in names(folder, 'lost/spool/running')), 20),
           'its take is put back')
    print('put back %.1f s after SIGKILL' % (time.monotonic() - before))
    run(folder, 'scancel', '--signal=KILL', '--full', job)
    expect(wait_until(lambda: not names(folder, 'lost/spool/running'), 20), 'so is the other')
    run(folder, 'scancel', job)
    run(folder, os.path.join(cluster, 'slurm.sh'), 'lost/spool', '2')
    finish(manager, folder, 'lost')


def others(folder):
    manager = manage(folder, 'mpi')
    done = run(folder, os.path.join(cluster, 'mpi.sh'), 'mpi/spool', '2', '--oversubscribe', '--mca', 'btl', 'tcp,self')
    expect(done.returncode == 0, 'two ranks ' + done.stderr[-200:])
    finish(manager, folder, 'mpi')
    manager = manage(folder, 'parallel')
    done = run(folder, os.path.join(cluster, 'parallel.sh'), 'parallel/spool', '2')
    expect(done.returncode == 0, 'GNU parallel ' + done.stderr[-200:])
    finish(manager, folder, 'parallel')


def speed(folder):
    """Evaluations of a search, each of which only lasts, as on processors of their own."""
    for n in 1, 2:
        wait_until(lambda: not run(folder, 'squeue', '--noheader').stdout.strip())
        spool = os.path.join(folder, 'speed-%d' % n)
        run(folder, 'sbatch', '--array=1-%d' % n, '--output=/dev/null', '--wrap', '%s work %s lasts' % (bench, spool))
        done = run(folder, bench, 'manage', spool, str(n))
        print('%d node(s): %s' % (n, done.stdout.strip()), flush=True)


def end(folder):
    # A step whose controller is gone would wait for it.
    run(folder, 'scancel', '--user=root')
    wait_until(lambda: not run(folder, 'squeue', '--noheader').stdout.strip(), 30)
    for daemon in reversed(daemons):
        daemon.terminate()
        try:
            daemon.wait(20)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()


needed = [name for name in ('slurmctld', 'slurmd', 'munged', 'mpirun', 'parallel')
          if not shutil.which(name, path=os.environ['PATH'] + ':/usr/sbin')]
if needed or os.geteuid():
    print('skipped: needs root and ' + ', '.join(needed))
    sys.exit(SKIP)
os.environ.update(PATH='%s:%s:/usr/sbin' % (os.path.dirname(tool), os.environ['PATH']), LC_ALL='C.UTF-8',
                  OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')
with tempfile.TemporaryDirectory(prefix='cloth-cluster-') as scratch:
    try:
        if start_slurm(scratch):
            run(scratch, tool, 'simulate', knit, '--scene', drag, '--output', 'base')
            with open(os.path.join(scratch, 'list.txt'), 'w', encoding='utf-8') as file:
                file.write(('%s --baseline base\n%s --simulated base\n' % (drag, drag)) * 3)
            expect(run(scratch, *survey('alone', '--workers', '1')).returncode == 0, 'one worker')
            for part in slurm, lost, others, speed:
                part(scratch)
        else:
            expect(False, 'Slurm does not start')
            for name in 'slurmctld.log', 'one.log', 'two.log':
                path = os.path.join(scratch, name)
                if os.path.exists(path):
                    with open(path, encoding='utf-8', errors='replace') as file:
                        print('%s: %s' % (name, file.read()[-1500:]))
    finally:
        end(scratch)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
