"""The completion of `proleg` for fish, with what each option does. It starts a program only for the names of scenarios."""

from help_texts import brief, kind_of, positional_kinds, with_actions

HEAD = r"""# fish completion of proleg. tools/docs.d/fish_completion.py has written it.

# The command, with its action, of the line that is typed.
function __proleg_place
    set -l words (commandline -opc)
    set -q words[2]; or return 1
    if set -q words[3]; and contains -- "$words[2] $words[3]" @ACTIONS@
        echo "$words[2] $words[3]"
    else
        echo $words[2]
    end
end

function __proleg_at
    test (count (commandline -opc)) -gt 1; and test "$(__proleg_place)" = "$argv[1]"
end

# Whether the word that is typed is argument $argv[2] (a number, or all) of command $argv[1]; $argv[3..] are its options with a value.
function __proleg_argument
    __proleg_at $argv[1]; and not string match -q -- '-*' (commandline -ct); or return 1
    set -l words (commandline -opc)
    set -l position 1
    set -l is_value 0
    for word in $words[(math 2 + (count (string split ' ' -- $argv[1])))..]
        if test $is_value = 1
            set is_value 0
        else if contains -- $word $argv[3..]
            set is_value 1
        else if not string match -q -- '-*' $word
            set position (math $position + 1)
        end
    end
    test $is_value = 0; and contains -- $argv[2] all $position
end

# Folders, and files whose names end in $argv[1].
function __proleg_files
    __fish_complete_path (commandline -ct) | string match -r -- '.*(?:/|'(string escape --style=regex -- $argv[1])')(?:\t.*)?$'
end

function __proleg_scenarios
    set -l words (commandline -opc)
    type -q -- $words[1]; or return
    $words[1] scenarios 2>/dev/null | string match -r -g '^  ([A-Za-z0-9_.-]+) '
end

complete -c proleg -f
complete -c proleg -n 'test (count (commandline -opc)) -eq 1' -s h -l help -d 'list the subcommands'
complete -c proleg -n 'test (count (commandline -opc)) -eq 1' -l version -d 'print version and build'
"""


def quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def suggested(kind, detail):
    """The arguments of `complete` that name what completes a value."""
    if kind == "words":
        return f" -a {quoted(' '.join(detail))}"
    if kind == "file" and detail:
        return f" -a {quoted(f'(__proleg_files {detail})')}"
    return {"file": " -F", "folder": " -a '(__fish_complete_directories)'",
            "scenario": " -a '(__proleg_files .simulation.xml) (__proleg_scenarios)'"}.get(kind, "")


def name_of(name):
    if name.startswith("--"):
        return f"-l {quoted(name[2:])}"
    return f"-s {quoted(name[1:])}" if len(name) == 2 else f"-o {quoted(name[1:])}"


def script(commands):
    actions = [" ".join(action.words) for command in commands for action in command.actions]
    text = HEAD.replace("@ACTIONS@", " ".join(map(quoted, actions)) or "''")
    for command in commands:
        text += (f"complete -c proleg -n 'test (count (commandline -opc)) -eq 1' -a {command.words[0]} "
                 f"-d {quoted(command.summary)}\n")
    for command in with_actions(commands):
        place = " ".join(command.words)
        for option in command.options:
            kind, detail = kind_of(option) if option.value else (None, None)
            value = ("" if not option.value else " -r" if kind == "file" and not detail else " -x") + suggested(kind, detail)
            names = " ".join(map(name_of, option.names))
            text += f"complete -c proleg -n {quoted(f'__proleg_at {quoted(place)}')} {names}{value} -d {quoted(brief(option.meaning))}\n"
        valued = " ".join(name for option in command.options if option.value for name in option.names)
        for number, (argument, kind, detail) in enumerate(positional_kinds(command), start=1):
            if kind:
                condition = f"__proleg_argument {quoted(place)} {'all' if argument.repeated else number} {valued}".rstrip()
                text += f"complete -c proleg -n {quoted(condition)}{suggested(kind, detail)} -d {quoted(argument.value)}\n"
    return text
