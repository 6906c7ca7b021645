#include "host/server/signal_layout.hpp"

#include <stdexcept>
#include <utility>

namespace proleg::host {
namespace {

using nlohmann::json;

const char* text_of(SignalOf of) {
  switch (of) {
    case SignalOf::joint:
      return "joint";
    case SignalOf::link:
      return "link";
    case SignalOf::robot:
      return "robot";
  }
  return "";
}

/// The 32-bit FNV-1a hash of a text.
std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = 2166136261U;
  for (const char character : text) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 16777619U;
  }
  return hash;
}

}  // namespace

SignalLayout::SignalLayout(std::vector<Signal> signals) : signals_(std::move(signals)) {
  for (const Signal& signal : signals_) {
    if (find(signal.name) != nullptr) {
      throw std::invalid_argument("found two signals '" + signal.name + "', expected different names");
    }
    columns_.push_back({row_size_, signal.count});
    row_size_ += signal.count;
  }
  hash_ = hash_of(document(0).dump(-1, ' ', false, json::error_handler_t::replace));
}

const SignalColumns* SignalLayout::find(std::string_view name) const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (signals_[i].name == name) {
      return &columns_[i];
    }
  }
  return nullptr;
}

json SignalLayout::document(std::uint32_t tick_us) const {
  json signals = json::array();
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const Signal& signal = signals_[i];
    signals.push_back({{"name", signal.name},
                       {"unit", signal.unit},
                       {"scale", signal.scale},
                       {"offset", columns_[i].offset},
                       {"count", signal.count},
                       {"of", text_of(signal.of)}});
  }
  return {{"hash", hash_}, {"tick_us", tick_us}, {"signals", signals}};
}

}  // namespace proleg::host
