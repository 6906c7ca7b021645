#include "host/remote/binding_store.hpp"

#include <fstream>
#include <stdexcept>
#include <system_error>

#include "host/remote/binding_file.hpp"
#include "shared/computer/errors/file_error.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"

namespace proleg::host {
namespace {

/// The text of a file; nothing if there is no such file.
std::optional<std::string> file_text(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return std::nullopt;
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path.string(), 0, "no ordinary file", "bindings of a remote control");
  }
  std::ifstream file(path, std::ios::binary);
  std::string text(max_binding_file_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) {
    throw FileError(path, "cannot be read");
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

}  // namespace

BindingStore::BindingStore(const std::filesystem::path& path) : path_(path), text_(file_text(path)) {
  if (text_) {
    bindings_ = host::read_bindings(*text_, path.string());
  }
}

bool BindingStore::has(const std::vector<Binding>& bindings) const {
  return bindings_text(bindings) == (text_ ? bindings_text(bindings_) : bindings_text({}));
}

void BindingStore::save(const std::vector<Binding>& bindings) {
  if (path_.empty()) {
    throw std::runtime_error("there is no scenario file beside which bindings can be saved: start `proleg ui FILE`");
  }
  if (file_text(path_) != text_) {
    throw std::runtime_error(path_.string() + ": somebody has changed the file meanwhile; nothing was written");
  }
  const std::string text = bindings_text(bindings);
  write_file(path_, text);
  text_ = text;
  bindings_ = bindings;
}

}  // namespace proleg::host
