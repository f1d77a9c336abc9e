#!/usr/bin/env bash
# Runs a campaign as a job array of Slurm, a shard a job, and merges the shards when all have ended well.
#   tools/slurm.sh OUT SHARDS arena|study [OPTION...]      JINK_PROGRAM is the program, jink unless told
# A job that was requeued goes on where it was. What Slurm needs to know besides (partition, time) comes from its own
# variables, as SBATCH_PARTITION and SBATCH_TIMELIMIT.
set -euo pipefail
out=${1:?a folder for the results}; shards=${2:?how many shards}; command=${3:?arena or study}; shift 3
jink=${JINK_PROGRAM:-jink}
part() { echo "$out.parts/$1-of-$shards"; }
case ${SLURM_ARRAY_TASK_ID:-${JINK_SLURM_MERGE:+merge}} in
"")
  mkdir -p "$out.parts"
  array=$(sbatch --parsable --requeue --array="1-$shards" --output="$out.parts/%a.log" "$0" "$out" "$shards" "$command" "$@")
  JINK_SLURM_MERGE=1 sbatch --dependency="afterok:${array%%;*}" --output="$out.parts/merge.log" "$0" "$out" "$shards" "$command"
  ;;
merge)
  parts=(); for k in $(seq "$shards"); do parts+=("$(part "$k")"); done
  exec "$jink" "$command" --merge "${parts[@]}" --out "$out"
  ;;
*)
  resume=(); [ ! -e "$(part "$SLURM_ARRAY_TASK_ID")" ] || resume=(--resume)
  exec "$jink" "$command" "$@" --threads "${SLURM_CPUS_PER_TASK:-1}" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
    --out "$(part "$SLURM_ARRAY_TASK_ID")" ${resume[@]+"${resume[@]}"}
  ;;
esac
