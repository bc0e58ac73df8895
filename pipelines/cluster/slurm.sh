#!/bin/sh
# Starts workers of a survey as an array of Slurm jobs, and returns at once.
#
#   pipelines/cluster/slurm.sh SPOOL N [OPTION…]
#
# N: workers. Further options are sbatch's, such as --partition or --cpus-per-task. A worker that
# Slurm preempts, or whose node is lost, is requeued; one that reaches its time limit is not. Its take
# goes to whoever is free.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -eu
spool=$(realpath -m "$1") n=$2
shift 2
mkdir -p "$spool/logs"
CLOTH_SPOOL=$spool sbatch --parsable --array="1-$n" --requeue --job-name=cloth-survey \
  --output="$spool/logs/%A-%a.txt" "$@" << 'END'
#!/bin/sh
exec gst-cloth-gap-1.0 survey --worker --spool "$CLOTH_SPOOL"
END
