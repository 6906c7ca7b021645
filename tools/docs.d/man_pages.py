"""Manual pages of `proleg` and its commands, in the language of man(7)."""

import re

SPECIAL = {"\\": r"\e", "-": r"\-", "'": r"\(aq", "`": r"\(ga", "^": r"\(ha", "~": r"\(ti", '"': r"\(dq"}

EXIT_STATUS = (("0", "Success."), ("1", "The run failed, or found what it looked for: a difference, a fault."),
               ("2", "Bad input: an option, a file or a value."))
# Variables of the environment, with the commands that read them although their help texts do not name them.
ENVIRONMENT = (
    ("PROLEG_BUS", (), "Where the robot is, for commands without --bus. The values are those of --bus."),
    ("PROLEG_PLUGINS", ("drive",), "The folder in which 'proleg drive' finds a plug-in that a robot's file names, before lib/ and lib/proleg/ "
                                   "beside the folder of the programs."),
)
FILES = (
    ("*.simulation.xml", "A scenario: the file that names the robot, its gait and its environment."),
    ("*.optimise.xml", "An experiment: what 'proleg optimise' searches for."),
    ("*.proleg", "A recording of a run, a database of SQLite."),
    ("*.pimg", "An image, which is flashed into modules."),
)


def roff(text):
    """Text as it is: no character begins a request or an escape. A line stays a line."""
    text = "".join(SPECIAL.get(character, character if ord(character) < 128 else rf"\[u{ord(character):04X}]") for character in text)
    return re.sub(r"^(?=\.)", r"\\&", text, flags=re.MULTILINE)


def prose(text):
    """A sentence: what it quotes of a command is bold."""
    parts = re.split(r"'(proleg(?: [^']*)?)'", text)
    return "".join(rf"\fB{roff(part)}\fR" if index % 2 else roff(part) if index == 0 else roff(part).removeprefix(r"\&")
                   for index, part in enumerate(parts))


def paragraphs(text):
    return "\n.PP\n".join(prose(line.strip()) for line in text.splitlines() if line.strip())


def entry(head, meaning):
    return f".TP\n{head}\n{paragraphs(meaning) or '.'}\n" if meaning else f".TP\n{head}\n\\&\n"


def head_of(argument):
    """The names in bold, the name of the value in italics, and what else the help text says of it."""
    if not argument.names:
        return rf"\fI{roff(argument.value)}\fR" + (" ..." if argument.repeated else "")
    head = ", ".join(rf"\fB{roff(name)}\fR" for name in argument.names)
    if argument.value:
        head += rf" \fI{roff(argument.value)}\fR" + (" ..." if argument.repeated else "")
    notes = ([f"default: {argument.default}"] if argument.default else []) + (["required"] if argument.required else [])
    notes += [note[0].lower() + note[1:].rstrip() for note in re.findall(r" ((?:Excludes|Needs): [^:]*)(?= [A-Z][a-z]+:|$)", argument.text)]
    return head + (f" ({roff('; '.join(notes))})" if notes else "")


def synopsis(command):
    words = ["proleg", *command.words]
    rest = command.usage.split()[len(words):]
    marked = " ".join(re.sub(r"[A-Za-z]+", lambda match: rf"\fI{match.group()}\fR", roff(word)) for word in rest)
    return rf"\fB{roff(' '.join(words))}\fR {marked}".rstrip()


def arguments(command, macro):
    text = ""
    for name, found in command.sections:
        title = "Arguments" if name == "Positionals" else name
        text += f"{macro} {title.upper() if macro == '.SH' else title}\n"
        text += "".join(entry(head_of(argument), argument.meaning) for argument in found)
    return text


def page(name, summary, version, date, body):
    """A line of TH has the date and the version, both of which may be ''."""
    return (f".TH {roff(name.upper())} 1 \"{date}\" \"{roff(version)}\" \"Commands of Proleg\"\n.nh\n.ad l\n"
            f".SH NAME\n{roff(name)} \\- {roff(summary)}\n{body}")


def exit_statuses():
    return ".SH EXIT STATUS\n" + "".join(entry(rf"\fB{status}\fR", meaning) for status, meaning in EXIT_STATUS)


def variables(found):
    return ".SH ENVIRONMENT\n" + "".join(entry(rf"\fB{roff(name)}\fR", meaning) for name, _, meaning in found) if found else ""


def see_also(names):
    return ".SH SEE ALSO\n" + ",\n".join(rf"\fB{roff(name)}\fR(1)" for name in names) + "\n"


def page_of_command(command, names, version, date):
    text = f".SH SYNOPSIS\n{synopsis(command)}\n"
    for action in command.actions:
        text += f".br\n{synopsis(action)}\n"
    text += f".SH DESCRIPTION\n{paragraphs(command.about)}\n{arguments(command, '.SH')}"
    for action in command.actions:
        text += f".SH {roff(' '.join(('proleg', *action.words)).upper())}\n{synopsis(action)}\n.PP\n{paragraphs(action.about)}\n"
        text += arguments(action, ".SS")
    everything = [command, *command.actions]
    said = " ".join(f"{part.about} {argument.meaning}" for part in everything for argument in (*part.options, *part.positionals))
    mentioned = [name for name in names if name != command.words[0] and re.search(rf"\bproleg {name}\b", said)]
    text += exit_statuses()
    text += variables([variable for variable in ENVIRONMENT if variable[0] in said or command.words[0] in variable[1]])
    text += see_also(["proleg", *(f"proleg-{name}" for name in sorted(mentioned))])
    return page(f"proleg-{command.words[0]}", command.summary, version, date, text)


def page_of_all(commands, version, date):
    text = ".SH SYNOPSIS\n\\fBproleg\\fR \\fISUBCOMMAND\\fR [\\fIOPTIONS\\fR]\n.br\n\\fBproleg\\fR \\-\\-help | \\-\\-version\n"
    text += (".SH DESCRIPTION\nProleg simulates and drives modular robots that crawl. Each subcommand has a manual page:\n"
             r"\fBman proleg\-simulate\fR." + "\n")
    text += ".SH SUBCOMMANDS\n" + "".join(entry(rf"\fB{roff(command.words[0])}\fR", command.summary) for command in commands)
    text += ".SH OPTIONS\n" + entry(r"\fB\-h\fR, \fB\-\-help\fR", "list the subcommands and exit")
    text += entry(r"\fB\-\-version\fR", "print version and build and exit")
    text += ".SH FILES\n" + "".join(entry(rf"\fI{roff(name)}\fR", meaning) for name, meaning in FILES)
    text += variables(ENVIRONMENT) + exit_statuses() + see_also(f"proleg-{command.words[0]}" for command in
                                                                sorted(commands, key=lambda command: command.words))
    return page("proleg", "simulate and drive modular robots that crawl", version, date, text)
