"""The completion of `proleg` for bash. It needs no other file and starts a program only for the names of scenarios."""

import shlex

from help_texts import kind_of, positional_kinds, with_actions

HEAD = r"""# bash completion of proleg. tools/docs.d/bash_completion.py has written it.

# Names of files and folders that begin with $1; of files, only those that end in $2.
_proleg_files() {
  local name
  compopt -o filenames 2>/dev/null
  while IFS= read -r name; do
    if [[ -d ${name/#\~\//$HOME/} || $name == *"$2" ]]; then
      COMPREPLY+=("$name")
    fi
  done < <(compgen -f -- "$1")
}

# What completes $1 as a value of the kind $2, with the words or the end of the file names $3.
_proleg_value() {
  case $2 in
    words) mapfile -t COMPREPLY < <(compgen -W "$3" -- "$1") ;;
    scenario)
      mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" scenarios 2>/dev/null | sed -n 's/^  \([A-Za-z0-9_.-]*\) .*/\1/p')" -- "$1")
      _proleg_files "$1" .simulation.xml ;;
    file) _proleg_files "$1" "$3" ;;
    folder)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$1") ;;
  esac
}

_proleg() {
  local cur=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} first=2 path=${COMP_WORDS[1]}
  local options='' valued='' position=1 index word
  COMPREPLY=()
  case $cur in
    [\'\"]*) cur=${cur:1} ;;
    *) cur=${cur//\\/} ;;
  esac
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '@COMMANDS@' -- "$cur")
    return
  fi
  if ((COMP_CWORD > 2)); then
    case "$path ${COMP_WORDS[2]}" in
      @ACTIONS@) path+=" ${COMP_WORDS[2]}" first=3 ;;
    esac
  fi
  case $path in
"""

TAIL = r"""    *) return ;;
  esac
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
    return
  fi
  # bash makes three words of --option=value.
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  if [[ " $valued " == *" $previous "* ]]; then
    case "$path $previous" in
@VALUES@    esac
    return
  fi
  for ((index = first; index < COMP_CWORD; ++index)); do
    word=${COMP_WORDS[index]}
    if [[ $word == = ]]; then
      ((++index))
    elif [[ $word != -* ]]; then
      ((++position))
    elif [[ " $valued " == *" $word "* && ${COMP_WORDS[index + 1]} != = ]]; then
      ((++index))
    fi
  done
  case "$path $position" in
@POSITIONS@  esac
}
complete -F _proleg proleg
"""


def call(kind, detail):
    detail = " ".join(detail) if kind == "words" else detail or ""
    return f'_proleg_value "$cur" {kind}' + (f" {shlex.quote(detail)}" if detail else "")


def script(commands):
    actions = [" ".join(action.words) for command in commands for action in command.actions]
    options, values, positions = "", "", ""
    for command in with_actions(commands):
        path = " ".join(command.words)
        names = [name for option in command.options for name in option.names]
        valued = [name for option in command.options if option.value for name in option.names]
        options += f"    {shlex.quote(path)})\n      options={shlex.quote(' '.join(names))}\n      valued={shlex.quote(' '.join(valued))} ;;\n"
        for option in command.options:
            kind, detail = kind_of(option)
            if kind and option.value:
                patterns = " | ".join(shlex.quote(f"{path} {name}") for name in option.names)
                values += f"      {patterns}) {call(kind, detail)} ;;\n"
        for number, (argument, kind, detail) in enumerate(positional_kinds(command), start=1):
            if kind:
                pattern = f"{shlex.quote(path + ' ')}*" if argument.repeated else shlex.quote(f"{path} {number}")
                positions += f"    {pattern}) {call(kind, detail)} ;;\n"
    head = HEAD.replace("@COMMANDS@", " ".join(["-h", "--help", "--version", *(command.words[0] for command in commands)]))
    head = head.replace("@ACTIONS@", " | ".join(map(shlex.quote, actions)) or "''")
    return head + options + TAIL.replace("@VALUES@", values).replace("@POSITIONS@", positions)
