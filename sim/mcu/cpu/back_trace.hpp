#pragma once

// Which functions had been called when a program stopped, from its stack and the call frame information that the
// compiler left in the image (DWARF 5, section 6.4).

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace proleg::sim {

/// Reads memory of the chip. Throws std::out_of_range where there is none.
using ReadMemory = std::function<void(std::uint32_t address, std::span<std::uint8_t> bytes)>;

struct CallFrame {
  std::uint32_t address = 0;  ///< of the instruction: where it stopped, or where a call returns to
  /// Exception whose handler this is the first function of, so that the next frame is what it interrupted; else 0.
  unsigned exception = 0;
  std::string text;  ///< for people: address, function, file and line
};

class BackTracer {
 public:
  static constexpr std::size_t max_frames = 32;

  /// The image, with its symbols; debug information (-g) is used if it is there. Throws ElfError.
  explicit BackTracer(const std::filesystem::path& image);
  ~BackTracer();
  BackTracer(const BackTracer&) = delete;
  BackTracer& operator=(const BackTracer&) = delete;

  /// "0x8000123 function(int)+14, file.cpp:12"; without what is not known.
  [[nodiscard]] std::string describe(std::uint32_t address) const;

  /// The innermost function first. registers: r0-r12, sp, lr, pc, xpsr. It ends at the function that started the
  /// program, at a frame that makes no sense, and where the interrupted code used the process stack; without debug
  /// information it has pc and lr only.
  [[nodiscard]] std::vector<CallFrame> trace(std::span<const std::uint32_t, 17> registers,
                                             const ReadMemory& read) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A trace for people, one line a frame.
[[nodiscard]] std::vector<std::string> trace_back(const std::filesystem::path& image,
                                                  std::span<const std::uint32_t, 17> registers, const ReadMemory& read);

}  // namespace proleg::sim
