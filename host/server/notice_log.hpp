#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "host/server/document_store.hpp"
#include "host/server/robot_session.hpp"

namespace proleg::host {

/// The message to a viewer about a notice.
[[nodiscard]] std::string notice_message(NoticeLevel level, const std::string& text);

/// The last notices, for present and later viewers.
class NoticeLog {
 public:
  static constexpr std::size_t max_notices = 200;

  void add(NoticeLevel level, const std::string& text);
  /// The first notice from this number on; `number` becomes that of the next notice. Null: there is no such notice
  /// yet.
  [[nodiscard]] SharedText next(std::uint64_t& number) const;

 private:
  std::uint64_t first_ = 0;  ///< number of the oldest notice
  std::deque<SharedText> notices_;
};

}  // namespace proleg::host
