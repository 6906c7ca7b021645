"""Constants of C++ sources: their names, from the text, and their values, from the compiler."""

import atexit
import dataclasses
import functools
import pathlib
import re
import subprocess
import tempfile


@dataclasses.dataclass(frozen=True)
class Constant:
    """A constexpr variable or function, an enumerator, or a member that is a register."""

    scope: str  # innermost namespace, class or enumeration that has a name and is not among PLAIN; or the function
    name: str
    is_local: bool = False  # inside a function
    declaration: str = ""

    @property
    def text(self):
        """Name as in the lists."""
        return (f"local::{self.scope}::" if self.is_local else f"{self.scope}::" if self.scope else "") + self.name


# Namespaces in which the expressions are compiled.
PLAIN = {"proleg", "sim", "stm32f405", ""}

COMMENT_OR_TEXT = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\])\'', re.S)
SCOPE = re.compile(r"\b(namespace|class|struct|enum)\b(?:\s+(?:class|struct)\b)?\s*((?:\w+::)*\w*)[^;{}()]*$")
FUNCTION = re.compile(r"(~?\w+)\s*\([^;{}]*$")


def without_comments(text):
    """The text with comments and the contents of strings as blanks; lines keep their places."""
    return COMMENT_OR_TEXT.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def end_of_block(text, opening):
    depth = 0
    for place in range(opening, len(text)):
        depth += {"{": 1, "}": -1}.get(text[place], 0)
        if depth == 0:
            return place
    raise ValueError("a brace is not closed")


def without_blocks(text):
    """The text without the contents of braces, brackets and parentheses."""
    depth = 0
    kept = []
    for character in text:
        depth -= character in ")]}"
        kept.append(character if depth == 0 else "")
        depth += character in "([{"
    return "".join(kept)


def statement(text):
    """The text up to the first semicolon that is not in braces."""
    depth = 0
    for place, character in enumerate(text):
        depth += {"{": 1, "}": -1}.get(character, 0)
        if depth == 0 and character == ";":
            return text[:place + 1]
    raise ValueError("a statement does not end")


def scopes(text):
    """For each brace that opens: its place, its end, kind and name."""
    found = []
    start = 0
    for brace in re.finditer(r"[;{}]", text):
        if brace[0] == "{":
            head = text[start:brace.start()]
            if named := SCOPE.search(head):
                kind, name = named[1], named[2].split("::")[-1]
            elif (function := FUNCTION.search(head)) and function[1] not in ("if", "for", "while", "switch"):
                kind, name = "function", function[1]
            else:
                kind, name = "block", ""
            found.append((brace.start(), end_of_block(text, brace.start()), kind, name))
        start = brace.end()
    return found


def constants_of(text):
    """All constants that a source declares. ValueError for a declaration that is not understood."""
    text = without_comments(text)
    blocks = scopes(text)

    def surroundings(place):
        around = [block for block in blocks if block[0] < place < block[1]]
        functions = [block[3] for block in around if block[2] == "function"]
        if functions:
            return functions[0], True
        return next((block[3] for block in reversed(around) if block[3] not in PLAIN), ""), False

    constants = []
    for word in re.finditer(r"\bconstexpr\b", text):
        if re.search(r"\bif\s*$", text[:word.start()]):
            continue
        rest = text[word.end():]
        end = re.search(r"[=({;\[]", rest)
        names = re.findall(r"\w+", rest[:end.start()]) if end else []
        if names[-1:] == ["struct"]:  # of a type without a name
            closing = end_of_block(text, word.end() + end.start())
            names = re.findall(r"^}\s*(\w+)", text[closing:])
        if not names:
            raise ValueError(f"not understood: constexpr{rest[:60]!r}")
        scope, is_local = surroundings(word.start())
        if names[-1] == scope or names[:-1] == ["explicit"] or len(names) == 1 and end[0] == "(":
            continue  # a constructor
        declaration = statement(rest)
        if end[0] != "(" and re.search(r",\s*\w+\s*[={]", without_blocks(declaration[end.start():])):
            raise ValueError(f"more than one constant in a declaration: constexpr{declaration}")
        constants.append(Constant(scope, names[-1], is_local, "constexpr" + declaration))
    for member in re.finditer(r"\n *Register ((?:\w+, )*\w+);", text):
        scope, is_local = surroundings(member.start(1))
        constants += [Constant(scope, name, is_local) for name in member[1].split(", ")]
    for opening, end, kind, name in blocks:
        if kind == "enum":
            scope, is_local = surroundings(opening)
            is_scoped = re.search(r"\benum\s+(class|struct)\s+\w+[^;{}]*$", text[:opening])
            for enumerator in re.findall(r"(\w+)\s*(?:=[^,]*)?(?:,|$)", text[opening + 1:end].rstrip() + ","):
                constants.append(Constant(name if is_scoped else scope, enumerator, is_local))
    return constants


HEAD = """
#include <bit>
#include <cstdint>
#include <type_traits>
namespace registers_test {
template <class Value>
constexpr unsigned long long word(Value value) {
  if constexpr (std::is_enum_v<Value>) {
    return word(static_cast<std::underlying_type_t<Value>>(value));
  } else if constexpr (std::is_integral_v<Value>) {
    return static_cast<unsigned long long>(value);
  } else {
    return std::bit_cast<std::uintptr_t>(value);
  }
}
}  // namespace registers_test
"""


# Headers that most sources of the virtual chip include. They are compiled once: half of the time of a source.
STANDARD_HEADERS = ("algorithm array cstdint deque functional map memory optional span stdexcept string string_view "
                    "utility vector").split()


@functools.lru_cache(None)
def precompiled_headers(compiler):
    """The header of these headers."""
    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    header = pathlib.Path(folder.name) / "standard.hpp"
    header.write_text("".join(f"#include <{name}>\n" for name in STANDARD_HEADERS))
    subprocess.run([*compiler, "-x", "c++-header", str(header), "-o", f"{header}.gch"], check=True)
    return header


class Compiler:
    def __init__(self, program, objcopy, source_dir, folder):
        self.objcopy, self.source_dir, self.folder = objcopy, source_dir, folder
        self.command = (program, "-std=c++20", "-O0", "-w", "-fno-access-control")
        self.headers = precompiled_headers(self.command)

    def values(self, name, files, namespace, expressions, overlay=None):
        """Values of constant expressions in the sources of the files. overlay: a folder with changed files."""
        folders = [str(each) for each in (overlay, self.source_dir) if each]
        lines = [HEAD] + [f'#include "{file}"' for file in files] + [f"namespace {namespace} {{"]
        lines += self.local_declarations(files, expressions, overlay)
        lines.append('extern "C" [[gnu::used, gnu::section(".register_values")]] constinit const unsigned long long '
                     "register_values[] = {")
        lines += [f"  ::registers_test::word({expression})," for expression in expressions] + ["};", "}"]
        source = self.folder / f"{name}.cpp"
        source.write_text("\n".join(lines) + "\n")
        target, values = source.with_suffix(".o"), source.with_suffix(".values")
        prefix = ["-include", str(self.headers)] if namespace == "proleg::sim" else []
        subprocess.run([*self.command, *prefix, *(f"-I{folder}" for folder in folders), "-c", str(source), "-o",
                        str(target)], check=True)
        subprocess.run([self.objcopy, "-O", "binary", "--only-section=.register_values",
                        str(target), str(values)], check=True)
        raw = values.read_bytes()
        assert len(raw) == 8 * len(expressions), (name, len(raw), len(expressions))
        return [int.from_bytes(raw[8 * i:8 * i + 8], "little") for i in range(len(expressions))]

    def local_declarations(self, files, expressions, overlay):
        """Constants of functions that expressions name: they are declared again, in local::FUNCTION."""
        wanted = {tuple(found) for expression in expressions
                  for found in re.findall(r"\blocal::(\w+)::(\w+)", expression)}
        for file in files if wanted else []:
            path = overlay / file if overlay and (overlay / file).exists() else self.source_dir / file
            for constant in constants_of(path.read_text()):
                if constant.is_local and (constant.scope, constant.name) in wanted:
                    yield f"namespace local::{constant.scope} {{ {constant.declaration} }}"
