"""The completion of `proleg` for zsh, with what each option does. It starts a program only for the names of scenarios."""

import re

from help_texts import brief, kind_of, positional_kinds, with_actions

HEAD = r"""#compdef proleg
# zsh completion of proleg. tools/docs.d/zsh_completion.py has written it.

_proleg_scenarios() {
  local -a names
  names=(${(f)"$($program scenarios 2>/dev/null | sed -n 's/^  \([A-Za-z0-9_.-]*\) .*/\1/p')"})
  _alternative 'scenarios:scenario:compadd -a names' 'files:file:_files -g "*.simulation.xml"'
}

_proleg() {
  local program=${(Q)words[1]} place
  if (( CURRENT == 2 )); then
    local -a subcommands
    subcommands=(
@COMMANDS@    )
    _describe -t commands subcommand subcommands
    _arguments '(- *)-h[list the subcommands]' '(- *)--help[list the subcommands]' '(- *)--version[print version and build]'
    return
  fi
  place=$words[2]
  shift words
  (( CURRENT-- ))
  if (( CURRENT > 2 )); then
    case "$place $words[2]" in
      (@ACTIONS@)
        place+=" $words[2]"
        shift words
        (( CURRENT-- )) ;;
    esac
  fi
  case $place in
"""

TAIL = """  esac
}

_proleg "$@"
"""


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def described(text):
    """Text in a specification of _arguments or _describe."""
    return re.sub(r"([\\\[\]:])", r"\\\1", text)


def action(kind, detail):
    if kind == "words":
        return f"({' '.join(detail)})"
    if kind == "file" and detail:
        return f'_files -g "*{detail}"'
    return {"file": "_files", "folder": "_files -/", "scenario": "_proleg_scenarios"}.get(kind, " ")


def specifications(command):
    found = []
    for option in command.options:
        for name in option.names:
            others = f"({' '.join(option.names)})" if len(option.names) > 1 and not option.repeated else ""
            form = "*" if option.repeated else others
            sign = ("=" if name.startswith("--") else "+") if option.value else ""
            value = f":{described(option.value)}:{action(*kind_of(option))}" if option.value else ""
            found.append(quoted(f"{form}{name}{sign}[{described(brief(option.meaning))}]{value}"))
    for number, (argument, kind, detail) in enumerate(positional_kinds(command), start=1):
        place = "*:" if argument.repeated else f"{number}:" if argument.required else f"{number}::"
        found.append(quoted(f"{place}{described(argument.value)}:{action(kind, detail)}"))
    return found


def script(commands):
    listed = "".join(f"      {quoted(command.words[0] + ':' + described(command.summary))}\n" for command in commands)
    actions = [" ".join(part.words) for command in commands for part in command.actions]
    head = HEAD.replace("@COMMANDS@", listed).replace("@ACTIONS@", "|".join(map(quoted, actions)) or "''")
    cases = ""
    for command in with_actions(commands):
        lines = " \\\n        ".join(specifications(command))
        cases += f"    ({quoted(' '.join(command.words))})\n      _arguments \\\n        {lines} ;;\n"
    return head + cases + TAIL
