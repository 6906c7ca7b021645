#include "shared/gait/declaration.hpp"

namespace proleg {
namespace {

template <typename Named>
int find_by_name(std::span<const Named> items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace

int find_parameter(const Declaration& declaration, std::string_view name) {
  return find_by_name(declaration.parameters, name);
}

int find_internal_value(const Declaration& declaration, std::string_view name) {
  return find_by_name(declaration.internal_values, name);
}

}  // namespace proleg
