#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

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

}  // namespace proleg::host
