#include "tools/proleg/ui/image_build.hpp"

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/algorithm_files.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* compiler = "arm-none-eabi-g++";

/// What is behind a text, up to a blank; nothing if the text is not there.
std::optional<std::string> word_behind(std::string_view text, std::string_view before) {
  const std::size_t at = text.find(before);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view rest = text.substr(at + before.size());
  return std::string(rest.substr(0, rest.find_first_of(" \n")));
}

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// The figures that the build has written: "flash", "flash_limit", ...
std::map<std::string, std::uint32_t> read_figures(const fs::path& file) {
  std::map<std::string, std::uint32_t> figures;
  std::ifstream lines(file);
  std::string name;
  std::uint32_t value = 0;
  while (lines >> name >> value) {
    figures[name] = value;
  }
  return figures;
}

json figure(const std::map<std::string, std::uint32_t>& figures, const char* name) {
  const auto found = figures.find(name);
  return found == figures.end() ? json() : json(found->second);
}

/// The number of the source with which the algorithm is in the image, as the build has written it.
json sources_of(const fs::path& build, const std::string& algorithm) {
  std::ifstream file(build / "user_algorithms" / (algorithm + ".algorithm.cpp"));
  constexpr std::string_view define = "#define PROLEG_ALGORITHM_SOURCES ";
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(define)) {
      const std::string_view number = std::string_view(line).substr(define.size());
      const auto value = number.size() > 3 ? parse_whole<std::uint32_t>(number.substr(2, number.size() - 3), 16)
                                           : std::optional<std::uint32_t>();
      return value ? json(hexadecimal(*value, 8)) : json();
    }
  }
  return {};
}

}  // namespace

fs::path ImageBuild::program(const char* extension) const {
  return folder_ / "bin" / (std::string("proleg_stm32f405") + extension);
}

std::vector<std::vector<std::string>> ImageBuild::commands(std::span<const AlgorithmFolder> algorithms) const {
  std::string folders;
  for (const AlgorithmFolder& algorithm : algorithms) {
    check_algorithm_folder(algorithm.path.string(), "folders");
    folders += (folders.empty() ? "" : ";") + algorithm.path.string();
  }
  if (!is_installed(compiler)) {
    throw std::runtime_error(std::string("found no ") + compiler +
                             ", expected it in a folder of PATH: " + installing_command({compiler}));
  }
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw FileError(folder_, "cannot be made: " + error.message());
  }
  return {{"cmake", "--preset", "stm32f405", "-B", folder_.string(), "-DPROLEG_USER_ALGORITHMS=" + folders},
          {"cmake", "--build", folder_.string(), "--target", "proleg_stm32f405", "proleg_boot_stm32f405"}};
}

json ImageBuild::described(std::span<const AlgorithmFolder> algorithms) const {
  const std::string file = program(".pimg").string();
  const host::ImageFile image = host::read_image(file);
  const image::Header& header = image.header;
  const auto figures = read_figures(program(".size.tsv"));
  const std::string commit = hexadecimal_digits(header.commit);
  json contents = json::array();
  for (const AlgorithmFolder& algorithm : algorithms) {
    contents.push_back({{"name", algorithm.name}, {"sources", sources_of(folder_, algorithm.name)}});
  }
  return {{"file", one_line(file)},
          {"version", std::to_string(header.version.major) + '.' + std::to_string(header.version.minor) + '.' +
                          std::to_string(header.version.patch)},
          {"commit", commit.find_first_not_of('0') == std::string::npos ? json() : json(commit)},
          {"changed_sources", header.has_changed_sources},
          {"core_fingerprint", hexadecimal(header.core_fingerprint, 8)},
          {"sha256", hexadecimal_digits(header.hash)},
          {"flash", figure(figures, "flash")},
          {"flash_limit", figure(figures, "flash_limit")},
          {"ram", figure(figures, "ram")},
          {"ram_limit", figure(figures, "ram_limit")},
          {"stack", figure(figures, "stack_bound")},
          {"stack_limit", figure(figures, "stack")},
          {"algorithms", std::move(contents)},
          {"command", one_line("proleg flash --bus can0 " + shell_argument(file))}};
}

void ImageBuild::discard() const {
  for (const char* extension : {".pimg", ".elf"}) {
    std::error_code ignored;
    fs::remove(program(extension), ignored);
  }
}

std::string ImageBuild::problem(std::string_view output) const {
  if (has(output, "No space left on device")) {
    return "the disk of " + one_line(folder_.string()) + " is full; make room, then build again";
  }
  if (has(output, "Read-only file system") || has(output, "Permission denied")) {
    return "a file in " + one_line(folder_.string()) + " cannot be written";
  }
  if (const auto bytes = word_behind(output, "overflowed by ")) {
    return "the algorithms are " + *bytes + " bytes too large for a module; leave one out, or make them smaller";
  }
  if (has(output, "the image is larger than max_image_size")) {
    return "the algorithms are too large for the flash of a module; leave one out, or make them smaller";
  }
  const auto stack = word_behind(output, "found a stack of ");
  const auto need = word_behind(output, "bytes, expected the ");
  if (stack && need) {
    return "the algorithms need too much stack: " + *need + " bytes at worst, a module has " + *stack;
  }
  return "";
}

}  // namespace proleg::tools
