"""What `proleg` and its commands print with --help, in parts. Manuals, manual pages and completions are made of it."""

import re
import subprocess
from dataclasses import dataclass, field

COLUMN = 30  # of the meanings; a longer argument has its meaning on the next line
# Commands whose first argument is a word that has its own help.
ACTIONS = ("ACTION", "WHAT")
WORD = r"[a-z][a-z0-9_-]*"
QUOTED_WORDS = re.compile(rf"((?:'{WORD}'(?:, | or ))+'{WORD}'): ")


@dataclass
class Argument:
    """An option (with names) or a positional argument (without), as a line of a help text states it."""
    text: str  # the line without the meaning: '-h,--help', '--over TEXT ... REQUIRED'
    meaning: str
    names: list = field(default_factory=list)
    value: str = ""  # the name of its value, such as FOLDER; '' for a switch
    default: str = ""
    repeated: bool = False
    required: bool = False

    def __post_init__(self):
        rest = re.split(r" (?:Excludes|Needs): ", self.text)[0]
        self.required = rest.endswith(" REQUIRED")
        rest = rest.removesuffix(" REQUIRED")
        self.repeated = rest.endswith(" ...")
        rest = rest.removesuffix(" ...")
        if rest.startswith("-"):
            names, _, rest = rest.partition(" ")
            self.names = names.split(",")
            # MODULE=JOINT,... is a form of a value; a default has no capital letters.
            default = re.fullmatch(r"([^=]+)=([^A-Z]*)", rest)
            self.value, self.default = default.groups() if default else (rest, "")
        else:
            self.value = rest.split(" ")[0]


@dataclass
class Command:
    words: tuple  # ('image', 'sign')
    summary: str  # one line, as the text above lists it
    about: str
    usage: str
    sections: list  # (name, [Argument])
    actions: list = field(default_factory=list)  # [Command]

    @property
    def options(self):
        return [argument for _, arguments in self.sections for argument in arguments if argument.names]

    @property
    def positionals(self):
        """Those that a user writes: the word of an action is one of words."""
        return [argument for _, arguments in self.sections for argument in arguments if not argument.names]


def help_of(programs, *words):
    result = subprocess.run([programs / "proleg", *words, "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60)
    if result.returncode != 0:
        raise SystemExit(f"tools/docs: 'proleg {' '.join(words)} --help' failed: {result.stderr.strip()}")
    return result.stdout.rstrip()


def split_line(line, next_line):
    """The argument of a line and its meaning. One blank before the column of the meanings can also be part of a long argument."""
    is_long = next_line.startswith(" " * COLUMN) and line[COLUMN - 2:COLUMN - 1] != " "
    if is_long or line[COLUMN - 1:COLUMN] != " ":
        return line.strip(), ""
    return line[:COLUMN].strip(), line[COLUMN:].strip()


def sections(text):
    """The text above 'Usage:', the usage, and the entries of each section: (name, [(argument, meaning)])."""
    about, _, rest = text.partition("Usage: ")
    usage, *blocks = re.split(r"\n+(?=\S.*:$)", rest, flags=re.MULTILINE)
    found = []
    for block in blocks:
        name, *lines = block.splitlines()
        entries = []
        for line, next_line in zip(lines, [*lines[1:], ""]):
            if line.startswith(" " * COLUMN) and entries:  # the meaning of a long argument, or another line of a meaning
                entries[-1][1] = f"{entries[-1][1]} {line.strip()}".strip()
            elif line.strip():
                entries.append([*split_line(line, next_line)])
        found.append((name.rstrip(":"), entries))
    return about.strip(), usage.strip(), found


def listed_commands(overview):
    """[(name, summary)] of the text that `proleg --help` prints."""
    return re.findall(r"^  ([a-z]+) +(\S.*)", overview, flags=re.MULTILINE)


def actions_with_help(programs, command, text):
    """The words for which `proleg COMMAND WORD --help` prints other text than `proleg COMMAND --help`."""
    about, _, found = sections(text)
    places = [about, *(meaning for name, entries in found if name == "Positionals" for argument, meaning in entries
                       if argument.startswith(ACTIONS))]
    if len(places) == 1:
        return {}
    actions = {}
    for word in dict.fromkeys(re.findall(r"\b[a-z][a-z-]+\b", " ".join(places))):
        result = subprocess.run([programs / "proleg", command, word, "--help"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                text=True, timeout=60)
        if result.returncode == 0 and result.stdout.rstrip() != text:
            actions[word] = result.stdout.rstrip()
    return actions


def command_of(words, summary, text, actions=None):
    """actions: the help texts of the command's actions."""
    about, usage, found = sections(text)
    parts = [command_of((*words, word), "", action_text) for word, action_text in (actions or {}).items()]
    for part in parts:
        part.summary = re.split(r"\.(?:\s|$)", part.about)[0]
    return Command(words, summary, about, usage, [(name, [Argument(*entry) for entry in entries]) for name, entries in found], parts)


def read_commands(programs):
    """All commands, in the order in which `proleg --help` lists them."""
    commands = []
    for name, summary in listed_commands(help_of(programs)):
        text = help_of(programs, name)
        commands.append(command_of((name,), summary, text, actions_with_help(programs, name, text)))
    return commands


def known_words(argument):
    """The words that a meaning states in one of these forms, after a sentence or a label; [] if it has none of them:
    'a', 'b' or 'c': ...        a, b or c        a: ...; b: ...        a (...); b (...)"""
    quoted = QUOTED_WORDS.match(argument.meaning)
    if quoted:
        return re.findall(WORD, quoted.group(1).replace(" or ", " "))
    for text in dict.fromkeys((argument.meaning, argument.meaning.partition(". ")[2], argument.meaning.partition(": ")[2])):
        if re.fullmatch(rf"{WORD}(?:, {WORD})* or {WORD}", text):
            return re.split(r", | or ", text)
        parts = re.sub(r"\([^()]*\)", "()", text).split("; ")
        for form in (r"[^ :]+: .*", rf"{WORD} \(\)"):
            if len(parts) > 1 and all(re.fullmatch(form, part) for part in parts):
                return [word for word in (re.split(r":? ", part)[0] for part in parts) if re.fullmatch(WORD, word)]
    return []


def kind_of(argument):
    """What completes the value of an argument: ('words', [...]), ('scenario', None), ('file', end of the names or ''),
    ('folder', None), or (None, None) where the help text does not say it."""
    words = known_words(argument)
    if words:
        return "words", words
    meaning = argument.meaning
    if "'proleg scenarios' lists" in meaning:
        return "scenario", None
    if argument.value == "FOLDER" or argument.value == "TEXT" and re.search(r"^folder\b|\bthis folder\b", meaning):
        return "folder", None
    if argument.value in ("FILE", "IMAGE", "BODY", "RUN", "LIBRARY", "ROBOT") or argument.value == "TEXT" and re.search(
            r"\binto this file\b|^(?:FILE|ELF|RECORDING)\b|\bor a file\b", meaning):
        ends = re.findall(r"(?<![\w*])\*?(\.[a-z][\w.]*\w) file|\*(\.[a-z][\w.]*\w)", meaning)
        ends = sorted({one or other for one, other in ends})
        return "file", ends[0] if len(ends) == 1 and not re.search(r"\bor\b", meaning) else ""
    return None, None


def brief(meaning, length=90):
    """The first sentence of a meaning without the words that it states first, for a list of options."""
    first = re.split(r"(?<=[^.][^.])\.(?:\s|$)", QUOTED_WORDS.sub("", " ".join(meaning.split())))[0]
    return first if len(first) <= length else first[:length].rsplit(" ", 1)[0].rstrip(",;:") + " ..."


def with_actions(commands):
    """Each command, followed by its actions."""
    return [part for command in commands for part in (command, *command.actions)]


def positional_kinds(command):
    """[(argument, kind, detail)] of the positional arguments; the first word of a command with actions may name one."""
    found = []
    for argument in command.positionals:
        kind, detail = kind_of(argument)
        if command.actions and not found:
            kind, detail = "words", list(dict.fromkeys([*(detail or []), *(action.words[-1] for action in command.actions)]))
        found.append((argument, kind, detail))
    return found
