#include "tools/proleg/ui/change_history.hpp"

#include <algorithm>
#include <utility>

namespace proleg::tools {

void ChangeHistory::add(Entry entry) {
  const bool continues =
      done_ == entries_.size() && done_ > 0 && entry.gesture && entries_.back().gesture == entry.gesture;
  entries_.resize(done_);
  if (!continues) {
    if (entries_.size() == max_entries) {
      entries_.erase(entries_.begin());
    }
    entries_.push_back(std::move(entry));
    done_ = entries_.size();
    return;
  }
  std::vector<Step>& steps = entries_.back().steps;
  for (const Step& step : entry.steps) {
    const auto earlier = std::ranges::find(steps, step.place, &Step::place);
    if (earlier != steps.end()) {
      earlier->after = step.after;
    } else {
      steps.push_back(step);
    }
  }
}

}  // namespace proleg::tools
