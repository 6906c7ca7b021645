#include "host/remote/element_learning.hpp"

#include <cmath>

namespace proleg::host {

bool ElementLearning::is_moved(const ElementPlace& element, double position) {
  const auto [start, is_new] = starts_.try_emplace(element, position);
  return !is_new && std::abs(position - start->second) >= clear_movement;
}

}  // namespace proleg::host
