"""Manuals of `proleg` and its commands, from what they print with --help."""

import html
import re

from help_texts import actions_with_help, help_of, listed_commands, sections


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


def pages_about(command, pages):
    """The pages that use a command, those first that use it most."""
    uses = {name: len(re.findall(rf"\bproleg {command}\b", text)) for name, text in pages.items() if name != "changelog.md"}
    return [name for name, count in sorted(uses.items(), key=lambda use: -use[1]) if count][:5]


def write_manuals(programs, pages, folder):
    """Writes a page for each command and returns the names of the files. pages: the texts of the site's other pages."""
    folder.mkdir()
    listed = listed_commands(help_of(programs))
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
