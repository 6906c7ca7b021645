#include "tools/proleg/ui/telemetry_layout.hpp"

#include <utility>

namespace proleg::tools {
namespace {

host::SignalOf of(Signal::Of of) {
  switch (of) {
    case Signal::Of::joint:
      return host::SignalOf::joint;
    case Signal::Of::link:
      return host::SignalOf::link;
    case Signal::Of::robot:
      break;
  }
  return host::SignalOf::robot;
}

}  // namespace

host::SignalLayout layout_of(const std::vector<Signal>& signals) {
  std::vector<host::Signal> shown;
  shown.reserve(signals.size());
  for (const Signal& signal : signals) {
    shown.push_back({signal.name, signal.unit, signal.scale, signal.places.size(), of(signal.of)});
  }
  return host::SignalLayout(std::move(shown));
}

}  // namespace proleg::tools
