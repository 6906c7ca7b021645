"""The public headers of the core as pages, one for each room, from what doxygen reads in them; and the C header of plug-ins."""

import re
import subprocess
import xml.etree.ElementTree as ElementTree

PLUGIN_HEADER = "host/robot_control_abi/robot_control.h"
DOXYGEN = """
INPUT = {source}/shared
RECURSIVE = YES
FILE_PATTERNS = *.hpp
STRIP_FROM_PATH = {source}
OUTPUT_DIRECTORY = {output}
XML_OUTPUT = .
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
GENERATE_HTML = NO
GENERATE_LATEX = NO
EXTRACT_ALL = YES
EXTRACT_STATIC = YES
JAVADOC_AUTOBRIEF = YES
HIDE_UNDOC_RELATIONS = YES
QUIET = YES
"""
LONGEST_VALUE = 40  # characters of a constant's value; longer ones are tables


def words(element):
    """The text of a description, as Markdown."""
    if element is None:
        return ""
    text = re.sub(r"([\\`*_\[\]<>|])", r"\\\1", element.text or "")
    for child in element:
        inner = words(child)
        if child.tag == "computeroutput":
            inner = f"`{''.join(child.itertext())}`"
        elif child.tag == "listitem":
            inner = f"\n- {' '.join(inner.split())}"
        elif child.tag in ("para", "itemizedlist", "orderedlist"):
            inner = f"\n\n{inner.strip()}\n\n"
        elif child.tag in ("verbatim", "programlisting"):
            inner = f"\n\n```text\n{''.join(child.itertext())}\n```\n\n"
        text += inner + re.sub(r"([\\`*_\[\]<>|])", r"\\\1", child.tail or "")
    return text


def description(member):
    """The words about a declaration. Doxygen parts the first sentence of a comment from the others; they are one text."""
    text = " ".join(words(member.find(part)).strip() for part in ("briefdescription", "detaileddescription"))
    text = re.sub(r" *\n *", "\n", re.sub(r"[ \t]+", " ", text))
    return re.sub(r"\n{2,}", "\n\n", text).strip()


def code(element):
    """C++ with the spaces of the project's style, not those of doxygen."""
    text = re.sub(r"\s+", " ", "".join(element.itertext()) if element is not None else "")
    text = re.sub(r"< | >", lambda match: match.group().strip(), text)
    text = re.sub(r" ([&*]+)(?=[\w.])", r"\1 ", text)
    text = re.sub(r" (?=[&*]+(?:$|[,)>]))", "", text)
    return re.sub(r" ?(?<![=!<>])=(?=[\w{])", " = ", text).strip()


def template_of(member):
    parameters = member.findall("templateparamlist/param")
    if not parameters:
        return ""
    return "template <" + ", ".join(" ".join(filter(None, (code(p.find("type")), code(p.find("declname"))))) for p in parameters) + ">\n"


def folded(text):
    """A declaration in lines of at most 110 characters."""
    if len(text) <= 110 or "(" not in text:
        return text
    head, _, tail = text.partition("(")
    return f"{head}(\n    " + ",\n    ".join(re.split(r", (?![^<]*>)", tail))


def declaration(member):
    kind, name = member.get("kind"), member.findtext("name")
    start = "static " if member.get("static") == "yes" and kind == "function" else ""
    if kind == "enum":
        base = code(member.find("type"))
        values = "".join(f"  {value.findtext('name')}{' ' + code(value.find('initializer')) if value.find('initializer') is not None else ''},"
                         f"{'  // ' + description(value) if description(value) else ''}\n" for value in member.findall("enumvalue"))
        return f"enum class {name}{' : ' + base if base else ''} {{\n{values}}};".replace("\\", "")
    if kind == "typedef":
        return code(member.find("definition")) + ";"
    if kind == "function":
        return folded(f"{template_of(member)}{start}{code(member.find('type'))} {name}{code(member.find('argsstring'))}".strip() + ";")
    value = code(member.find("initializer"))
    return f"{code(member.find('type'))} {name}{code(member.find('argsstring'))}{' ' + value if 0 < len(value) <= LONGEST_VALUE else ''};"


def is_of_use(member):
    return member.get("prot") != "private" and not re.search(r"= ?delete", code(member.find("argsstring"))) and \
        member.get("kind") in ("enum", "typedef", "function", "variable") and not member.findtext("name").startswith("@")


def line_of(member):
    return int(member.find("location").get("declline") or member.find("location").get("line"))


def members_text(members):
    """Prose and declarations; a declaration without words that follows another at once belongs to it."""
    groups = []
    for member in sorted(filter(is_of_use, members), key=line_of):
        about = description(member)
        lines = range(line_of(member) - 2, line_of(member))
        if groups and not about and groups[-1][2] in lines:
            groups[-1][1].append(declaration(member))
            groups[-1][2] = line_of(member)
        else:
            groups.append([about, [declaration(member)], line_of(member)])
    return "\n\n".join(f"```cpp\n{chr(10).join(declarations)}\n```\n\n{about}".strip() for about, declarations, _ in groups)


def class_text(compound):
    name = compound.findtext("compoundname").removeprefix("proleg::")
    members = [member for section in compound.findall("sectiondef") if "private" not in section.get("kind")
               for member in section.findall("memberdef")]
    fields = [member for member in members if member.get("kind") == "variable" and is_of_use(member)]
    parts = [f"### {compound.get('kind')} {name}", description(compound)]
    if fields:
        rows = "".join(f"| `{declaration(field).rstrip(';').replace('|', chr(92) + '|')}` | {re.sub(chr(10) + '+', ' ', description(field))} |\n"
                       for field in sorted(fields, key=line_of))
        parts.append(f"| member | what it is |\n| --- | --- |\n{rows}")
    parts.append(members_text(member for member in members if member.get("kind") != "variable"))
    return "\n\n".join(filter(None, (part.strip() for part in parts)))


def head_comment(text):
    """The comment above the first include of a header: what the file is."""
    match = re.search(r"#pragma once\n+((?://(?!/).*\n)+)", text)
    return re.sub(r"([<>*_])", r"\\\1", re.sub(r"^// ?", "", match.group(1), flags=re.MULTILINE)).strip() if match else ""


def read_compounds(xml):
    index = ElementTree.parse(xml / "index.xml").getroot()
    for entry in index:
        if entry.get("kind") in ("class", "struct", "union", "namespace"):
            yield ElementTree.parse(xml / f"{entry.get('refid')}.xml").getroot()[0]


def header_text(source, path, classes, members):
    parts = [f"## {path.name}", head_comment((source / path).read_text()), f"```cpp\n#include \"{path}\"\n```",
             members_text(members), *(class_text(one) for one in classes)]
    return "\n\n".join(filter(None, parts))


def write_pages(source, xml, folder):
    """Writes a page for each room of the core and one for plug-ins, and returns the names of the files."""
    folder.mkdir()
    xml.mkdir()
    subprocess.run(["doxygen", "-"], input=DOXYGEN.format(source=source.resolve(), output=xml.resolve()), text=True, check=True)
    classes, members = {}, {}
    for compound in read_compounds(xml):
        if compound.get("kind") != "namespace":
            classes.setdefault(compound.find("location").get("file"), []).append(compound)
            continue
        for member in compound.findall("sectiondef/memberdef"):
            place = member.find("location")
            members.setdefault(place.get("declfile") or place.get("file"), []).append(member)

    rooms = {}
    for path in sorted(source.glob("shared/**/*.hpp")):
        rooms.setdefault(path.parent.relative_to(source), []).append(path.relative_to(source))
    files = ["index.md"]
    rows = ""
    for room, headers in rooms.items():
        texts = [header_text(source, path, sorted(classes.get(str(path), []), key=line_of), members.get(str(path), [])) for path in headers]
        file = f"{str(room).replace('/', '_')}.md"
        (folder / file).write_text(f"# {room}\n\nWhat the headers of `{room}` declare. [How Proleg is built](../architecture.md) "
                                   "says what the room is for, and which other rooms may use it.\n\n" + "\n\n".join(texts) + "\n")
        rows += f"| [`{room}`]({file}) | {', '.join(f'`{path.name}`' for path in headers)} |\n"
        files.append(file)
    (folder / "plugin.md").write_text(
        "# Plug-ins for robots\n\nYou can connect a robot without Proleg's modules by a plug-in that includes this header and nothing else "
        f"([Plug-ins](../robot-control.md)): `{PLUGIN_HEADER}`.\n\n```c\n{(source / PLUGIN_HEADER).read_text()}```\n")
    files.append("plugin.md")
    (folder / "index.md").write_text(
        "# Interfaces\n\nYou find the headers of the core here, and what a plug-in includes. The pages are made from the headers. "
        "[How Proleg is built](../architecture.md) says which room may use which.\n\n"
        f"| room | headers |\n| --- | --- |\n{rows}| [plug-ins](plugin.md) | `robot_control.h` |\n")
    return files
