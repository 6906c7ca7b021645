#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "sim/scenario/reader.hpp"

namespace proleg::sim {

/// Files as they were read before: the sources of a scenario or of a recording.
class SourceTexts final : public FileSource {
 public:
  void add(const std::filesystem::path& path, std::string text) {
    texts_.insert_or_assign(path.lexically_normal().string(), std::move(text));
  }
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override {
    const auto found = texts_.find(path.lexically_normal().string());
    return found == texts_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::string, std::string> texts_;
};

}  // namespace proleg::sim
