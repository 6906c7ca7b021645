#pragma once

// The messages that all viewers get: the newest revision of each document, and the last notices.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "host/server/robot_session.hpp"

namespace proleg::host {

/// The bytes of a message to several viewers.
using SharedText = std::shared_ptr<const std::string>;

/// The revision of each document that a viewer has received.
using KnownRevisions = std::map<std::string, std::uint64_t>;

/// The newest revision of each document, as the message that viewers get. Revisions count the changes of all documents.
class DocumentStore {
 public:
  /// Stores a new revision of a document. `value` is JSON.
  void publish(const std::string& name, std::string_view value);
  /// The document whose newest revision has been unknown for the longest time, so that a document that changes all the
  /// time delays no other. It is marked as known. Null: all documents are known.
  [[nodiscard]] SharedText next(KnownRevisions& known) const;

 private:
  struct Document {
    std::uint64_t revision = 0;
    SharedText message;
  };

  std::uint64_t last_revision_ = 0;
  std::map<std::string, Document> documents_;
};

/// The message about a notice. number: in the log of all viewers; nothing: it is for one viewer.
[[nodiscard]] std::string notice_message(NoticeLevel level, const std::string& text,
                                         std::optional<std::uint64_t> number = {});

/// The last notices, for present and later viewers.
class NoticeLog {
 public:
  static constexpr std::size_t max_notices = 200;

  void add(NoticeLevel level, const std::string& text);
  /// The number of the notice that is added next. The first one has 0; the messages have their numbers.
  [[nodiscard]] std::uint64_t next_number() const { return first_ + notices_.size(); }
  /// The first notice from this number on; `number` becomes that of the next notice. Null: there is no such notice
  /// yet.
  [[nodiscard]] SharedText next(std::uint64_t& number) const;

 private:
  std::uint64_t first_ = 0;  ///< number of the oldest notice
  std::deque<SharedText> notices_;
};

}  // namespace proleg::host
