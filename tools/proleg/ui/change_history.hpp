#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/document/parameter_table.hpp"

namespace proleg::tools {

/// What a user changed, for undo and redo.
class ChangeHistory {
 public:
  /// The oldest entries beyond these are forgotten.
  static constexpr std::size_t max_entries = 200;

  struct Step {
    ParameterPlace place;
    std::int32_t before;
    std::int32_t after;
  };
  struct Entry {
    std::string name;  ///< of the change, for people
    std::vector<Step> steps;
    std::optional<std::uint64_t> gesture;
  };

  /// A new entry, after which nothing can be redone. With the gesture of the entry before, the two become one: a slider
  /// that is drawn makes many changes.
  void add(Entry entry);

  /// The entry that undo takes back; null: none.
  [[nodiscard]] const Entry* to_undo() const { return done_ > 0 ? &entries_[done_ - 1] : nullptr; }
  [[nodiscard]] const Entry* to_redo() const { return done_ < entries_.size() ? &entries_[done_] : nullptr; }
  /// Only if there is such an entry.
  void undone() { --done_; }
  void redone() { ++done_; }

 private:
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  ///< entries from here on are undone
};

}  // namespace proleg::tools
