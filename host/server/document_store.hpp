#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace proleg::host {

/// Bytes of a message that several viewers get.
using SharedText = std::shared_ptr<const std::string>;

/// The revisions of documents that a viewer has got.
using KnownRevisions = std::map<std::string, std::uint64_t>;

/// The newest revision of each document, as the message that viewers get. Revisions count the changes of all documents.
class DocumentStore {
 public:
  /// `value` is JSON.
  void publish(const std::string& name, std::string_view value);
  /// Of the documents whose newest revision is not known, the one that has been so for longest: a document that changes
  /// all the time delays no other. It is known from then on. Null: all are known.
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
