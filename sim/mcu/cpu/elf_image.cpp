#include "sim/mcu/cpu/elf_image.hpp"

#include <cxxabi.h>
#include <elf.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <type_traits>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

std::string demangled(const std::string& name) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return status == 0 ? text.get() : name;
}

/// The bytes of the file, read with every offset checked.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    constexpr std::uintmax_t largest = 256U << 20U;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > largest) {
      throw ElfError((file.empty() ? "\"\"" : file.string()) +
                     ": found no file, or one above 256 MiB, expected an ARM program");
    }
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
      throw ElfError(file.string() + ": found no readable file, expected an ARM program");
    }
    bytes_.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw ElfError(file_.string() + ": found " + found + ", expected " + expected);
  }

  [[nodiscard]] std::vector<std::uint8_t> bytes(std::size_t offset, std::size_t size) const {
    check(offset, size);
    const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return {first, first + static_cast<std::ptrdiff_t>(size)};
  }

  template <typename Record>
  [[nodiscard]] Record record(std::size_t offset) const {
    static_assert(std::is_trivially_copyable_v<Record>);
    check(offset, sizeof(Record));
    Record result;
    std::memcpy(&result, &bytes_[offset], sizeof(Record));
    return result;
  }

  /// A table of equal records.
  template <typename Record>
  [[nodiscard]] std::vector<Record> table(std::size_t offset, std::size_t count) const {
    std::vector<Record> records;
    for (std::size_t i = 0; i < count; ++i) {
      records.push_back(record<Record>(offset + i * sizeof(Record)));
    }
    return records;
  }

 private:
  void check(std::size_t offset, std::size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset) {
      fail("the end of the file at byte " + std::to_string(bytes_.size()),
           std::to_string(size) + " bytes at " + std::to_string(offset));
    }
  }

  const std::filesystem::path& file_;
  std::vector<std::uint8_t> bytes_;
};

Elf32_Ehdr read_header(const Reader& reader) {
  const auto header = reader.record<Elf32_Ehdr>(0);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) {
    reader.fail("a file without the ELF magic number", "an ARM program");
  }
  if (header.e_ident[EI_CLASS] != ELFCLASS32 || header.e_ident[EI_DATA] != ELFDATA2LSB) {
    reader.fail("a program that is not 32-bit little-endian", "an ARM program");
  }
  if (header.e_machine != EM_ARM || header.e_type != ET_EXEC) {
    reader.fail("machine " + std::to_string(header.e_machine) + ", type " + std::to_string(header.e_type),
                "a linked ARM program (machine 40, type 2)");
  }
  if (header.e_phentsize != sizeof(Elf32_Phdr) || header.e_shentsize != sizeof(Elf32_Shdr)) {
    reader.fail("table entries of unknown size", "a linked ARM program");
  }
  constexpr unsigned max_segments = 32;  // an image of a module has four segments; a damaged count is rarely small
  if (header.e_phnum == 0 || header.e_phnum > max_segments) {
    reader.fail(std::to_string(header.e_phnum) + " program headers", "1 to " + std::to_string(max_segments));
  }
  return header;
}

/// What the assembler marks as the begin of instructions ($t) or constants ($d) (ELF for the Arm Architecture, 5.5.5).
struct Mark {
  std::uint32_t address;
  bool is_code;
};

bool is_mark(const std::string& name) {
  return name.size() >= 2 && name[0] == '$' && (name[1] == 't' || name[1] == 'd' || name[1] == 'a') &&
         (name.size() == 2 || name[2] == '.');
}

std::vector<ElfImage::Code> code_of_section(const Reader& reader, const Elf32_Shdr& section, std::vector<Mark> marks) {
  std::stable_sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.address < b.address; });
  std::vector<ElfImage::Code> code;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const std::uint32_t end = i + 1 < marks.size() ? marks[i + 1].address : section.sh_addr + section.sh_size;
    if (marks[i].is_code && end > marks[i].address) {
      code.push_back({marks[i].address,
                      reader.bytes(section.sh_offset + (marks[i].address - section.sh_addr), end - marks[i].address)});
    }
  }
  return code;
}

}  // namespace

ElfImage::ElfImage(const std::filesystem::path& file) : file_(file) {
  const Reader reader(file);
  const Elf32_Ehdr header = read_header(reader);
  flags_ = header.e_flags;
  for (const auto& segment : reader.table<Elf32_Phdr>(header.e_phoff, header.e_phnum)) {
    if (segment.p_type == PT_LOAD && segment.p_filesz > 0) {
      segments_.push_back({segment.p_paddr, reader.bytes(segment.p_offset, segment.p_filesz)});
    }
  }

  const auto sections = reader.table<Elf32_Shdr>(header.e_shoff, header.e_shnum);
  std::vector<std::vector<Mark>> marks(sections.size());
  for (const Elf32_Shdr& section : sections) {
    if (section.sh_type == SHT_ARM_ATTRIBUTES) {
      attributes_ = reader.bytes(section.sh_offset, section.sh_size);
    }
    if (section.sh_type != SHT_SYMTAB) {
      continue;
    }
    if (section.sh_link >= sections.size()) {
      reader.fail("a symbol table without names", "a linked ARM program");
    }
    const Elf32_Shdr& names = sections[section.sh_link];
    std::vector<std::uint8_t> text = reader.bytes(names.sh_offset, names.sh_size);
    text.push_back(0);
    for (const auto& entry : reader.table<Elf32_Sym>(section.sh_offset, section.sh_size / sizeof(Elf32_Sym))) {
      if (entry.st_name >= text.size()) {
        reader.fail("a symbol with its name outside the table of names", "a linked ARM program");
      }
      const std::string name(reinterpret_cast<const char*>(&text[entry.st_name]));
      if (name.empty() || entry.st_shndx == SHN_UNDEF) {
        continue;
      }
      if (is_mark(name)) {
        if (entry.st_shndx < marks.size()) {
          marks[entry.st_shndx].push_back({entry.st_value, name[1] == 't'});
        }
        continue;
      }
      const bool is_function = ELF32_ST_TYPE(entry.st_info) == STT_FUNC;
      symbols_.push_back({name, is_function ? entry.st_value & ~1U : entry.st_value, entry.st_size, is_function});
    }
  }
  if (symbols_.empty()) {
    reader.fail("no symbol", "a program that was not stripped");
  }
  for (std::size_t i = 0; i < symbols_.size(); ++i) {
    const std::string readable = demangled(symbols_[i].name);
    qualified_names_.emplace(symbols_[i].name, i);
    if (readable != symbols_[i].name) {
      qualified_names_.emplace(readable.substr(0, readable.find('(')), i);
    }
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if ((sections[i].sh_flags & SHF_EXECINSTR) != 0) {
      const std::vector<Code> code = code_of_section(reader, sections[i], marks[i]);
      code_.insert(code_.end(), code.begin(), code.end());
    }
  }
}

const ElfImage::Symbol& ElfImage::symbol(std::string_view name) const {
  const auto [first, last] = qualified_names_.equal_range(name);
  const auto count = std::distance(first, last);
  if (count == 1) {
    return symbols_[first->second];
  }
  throw ElfError(file_.string() + ": found " + std::to_string(count) + " symbols \"" + std::string(name) +
                 "\", expected one");
}

std::string ElfImage::describe(std::uint32_t address) const {
  for (const Symbol& symbol : symbols_) {
    if (symbol.is_function && address >= symbol.address && address - symbol.address < symbol.size) {
      return hexadecimal(address) + " (" + demangled(symbol.name) + "+" + std::to_string(address - symbol.address) +
             ")";
    }
  }
  return hexadecimal(address);
}

}  // namespace proleg::sim
