# Completion of canonpose's commands and options in bash. It asks the program, so it is always of the version installed.
_canonpose() {
  local word=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]} command=${COMP_WORDS[1]}
  local options
  if [ "$COMP_CWORD" -eq 1 ]; then
    # Commands stand at the beginning of the lines after "Subcommands:".
    options=$("$program" help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p')
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [[ $word == -* ]]; then
    options=$("$program" help "$command" 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [ "$command" = import ] && [ "$COMP_CWORD" -eq 2 ]; then
    # "The detector's files: openpose, ...; or a benchmark's: h36m, ..."
    options=$("$program" help import 2>/dev/null | sed -n 's/^ *format .*files: \(.*\); or a benchmark.s: \(.*\)$/\1, \2/p' | tr -d ,)
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  fi
  # Anything else is a file or folder.
}
complete -o bashdefault -o default -F _canonpose canonpose
