#!/bin/sh
# Starts workers of a survey as the ranks of an MPI job. They talk by the spool's files only, so the
# program needs no MPI library.
#
#   pipelines/cluster/mpi.sh SPOOL N [OPTION…]
#
# N: ranks. Further options are mpirun's, such as --host one,two.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -eu
spool=$(realpath -m "$1") n=$2
shift 2
exec mpirun -n "$n" "$@" gst-cloth-gap-1.0 survey --worker --spool "$spool"
