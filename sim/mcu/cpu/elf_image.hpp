#pragma once

// A program for Cortex-M as the linker left it: what to put into which memory, and where its functions and data are.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

/// The file is missing or not what it should be. One line that names file, finding and expectation.
class ElfError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ElfImage {
 public:
  struct Segment {
    std::uint32_t load_address;
    std::vector<std::uint8_t> bytes;
  };

  struct Symbol {
    std::string name;
    std::uint32_t address;  ///< bit 0 of functions, which marks Thumb code, is cleared
    std::uint32_t size;
    bool is_function;
  };

  /// Instructions without the constants that lie between them.
  struct Code {
    std::uint32_t address;
    std::vector<std::uint8_t> bytes;
  };

  /// Reads a statically linked 32-bit little-endian ARM program.
  explicit ElfImage(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<Segment>& segments() const { return segments_; }
  [[nodiscard]] const std::vector<Symbol>& symbols() const { return symbols_; }
  [[nodiscard]] const std::vector<Code>& code() const { return code_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// e_flags (ELF for the Arm Architecture, 5.2).
  [[nodiscard]] std::uint32_t flags() const { return flags_; }
  /// Contents of .ARM.attributes, which say what the program was compiled for; empty if it has none.
  [[nodiscard]] const std::vector<std::uint8_t>& attributes() const { return attributes_; }

  /// The symbol of that name, which is mangled, or qualified and without arguments ("proleg::Kernel::advance").
  /// ElfError if there is none, or more than one.
  [[nodiscard]] const Symbol& symbol(std::string_view name) const;

  /// Describes an address for messages: "function+offset", demangled, or the bare address.
  [[nodiscard]] std::string describe(std::uint32_t address) const;

 private:
  std::filesystem::path file_;
  std::vector<Segment> segments_;
  std::vector<Symbol> symbols_;
  std::vector<Code> code_;
  std::uint32_t flags_ = 0;
  std::vector<std::uint8_t> attributes_;
  std::multimap<std::string, std::size_t, std::less<>> qualified_names_;  ///< index of the symbol
};

}  // namespace proleg::sim
