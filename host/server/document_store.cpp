#include "host/server/document_store.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace proleg::host {

void DocumentStore::publish(const std::string& name, std::string_view value) {
  Document& document = documents_[name];
  document.revision = ++last_revision_;
  std::string message = R"({"type":"document","name":)" + nlohmann::json(name).dump() + R"(,"revision":)" +
                        std::to_string(document.revision) + R"(,"value":)";
  message += value;
  message += '}';
  document.message = std::make_shared<const std::string>(std::move(message));
}

SharedText DocumentStore::next(KnownRevisions& known) const {
  auto oldest = documents_.end();
  for (auto document = documents_.begin(); document != documents_.end(); ++document) {
    const auto found = known.find(document->first);
    const bool is_known = found != known.end() && found->second == document->second.revision;
    if (!is_known && (oldest == documents_.end() || document->second.revision < oldest->second.revision)) {
      oldest = document;
    }
  }
  if (oldest == documents_.end()) {
    return nullptr;
  }
  known[oldest->first] = oldest->second.revision;
  return oldest->second.message;
}

}  // namespace proleg::host
