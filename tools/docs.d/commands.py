"""Manuals of `proleg` and its commands, from what they print with --help."""

import html
import re
import subprocess

ENTRY = re.compile(r"^  (\S(?:.*?\S)??)(?:\s{2,}(\S.*))?$")
# Commands whose first argument is a word that has its own help.
ACTIONS = ("ACTION", "WHAT")


def help_of(programs, *words):
    result = subprocess.run([programs / "proleg", *words, "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60)
    if result.returncode != 0:
        raise SystemExit(f"tools/docs: 'proleg {' '.join(words)} --help' failed: {result.stderr.strip()}")
    return result.stdout.rstrip()


def sections(text):
    """The text above 'Usage:', the usage, and the entries of each section: (name, [(argument, meaning)])."""
    about, _, rest = text.partition("Usage: ")
    usage, *blocks = re.split(r"\n+(?=\S.*:$)", rest, flags=re.MULTILINE)
    found = []
    for block in blocks:
        name, *lines = block.splitlines()
        entries = []
        for line in lines:
            if re.match(r" {12}", line):  # the meaning of a long argument is on the next line
                entries[-1][1] = f"{entries[-1][1]} {line.strip()}".strip()
            elif line.strip():
                entries.append([part or "" for part in ENTRY.match(line).groups()])
        found.append((name.rstrip(":"), entries))
    return about.strip(), usage.strip(), found


def as_markdown(text, pages):
    """A sentence of a help text: characters of Markdown and HTML as they are, names of pages as links."""
    text = re.sub(r"([\\`*_\[\]|])", r"\\\1", html.escape(text, quote=False))
    text = re.sub(r"'(proleg [^']*)'", r"`\1`", text)
    return re.sub(r"\bdocs/([\w-]+\.md)", lambda match: f"[{pages[match.group(1)].splitlines()[0][2:]}](../{match.group(1)})"
                  if match.group(1) in pages else match.group(), text)


def manual(text, pages, level):
    about, usage, found = sections(text)
    parts = ["\n\n".join(as_markdown(line, pages) for line in about.splitlines()), f"```text\n{usage}\n```"]
    for name, entries in found:
        rows = "".join(f"| `{argument.replace('|', chr(92) + '|')}` | {as_markdown(meaning, pages)} |\n" for argument, meaning in entries)
        heading, column = ("Arguments", "argument") if name == "Positionals" else (name, "option")
        parts.append(f"{'#' * level} {heading}\n\n| {column} | what it is |\n| --- | --- |\n{rows}".rstrip())
    return "\n\n".join(parts)


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


def pages_about(command, pages):
    """The pages that use a command, those first that use it most."""
    uses = {name: len(re.findall(rf"\bproleg {command}\b", text)) for name, text in pages.items() if name != "changelog.md"}
    return [name for name, count in sorted(uses.items(), key=lambda use: -use[1]) if count][:5]


def write_manuals(programs, pages, folder):
    """Writes a page for each command and returns the names of the files. pages: the texts of the site's other pages."""
    folder.mkdir()
    overview = help_of(programs)
    listed = re.findall(r"^  ([a-z]+) +(\S.*)", overview, flags=re.MULTILINE)
    files = ["index.md"]
    rows = "".join(f"| [`proleg {command}`]({command}.md) | {as_markdown(summary, pages)} |\n" for command, summary in listed)
    (folder / "index.md").write_text(
        "# Commands\n\nYou find the command for a task here, and behind its name all its options, as `proleg COMMAND --help` prints them.\n\n"
        f"| command | what it does |\n| --- | --- |\n{rows}")
    for command, summary in listed:
        text = help_of(programs, command)
        page = f"# proleg {command}\n\n{manual(text, pages, 2)}\n"
        for action, action_text in actions_with_help(programs, command, text).items():
            page += f"\n## proleg {command} {action}\n\n{manual(action_text, pages, 3)}\n"
        about = pages_about(command, pages)
        if about:
            links = ", ".join(f"[{pages[name].splitlines()[0][2:]}](../{name})" for name in about)
            page += f"\n## Pages that use it\n\n{links}\n"
        (folder / f"{command}.md").write_text(page)
        files.append(f"{command}.md")
    return files
