#include "firmware/module/board_store.hpp"

namespace proleg::firmware {

void BoardStore::load() {
  stored_ = newest(flash_.contents(0), flash_.contents(1)).value_or(BoardRecord{});
  has_newer_ = has_newer_schema(flash_.contents(0), flash_.contents(1));
  reset();
}

AppendResult BoardStore::save(const BoardRecord& record) {
  const AppendResult result = append(flash_, record);
  if (result == AppendResult::ok) {
    stored_ = record;
    has_newer_ = false;
  }
  return result;
}

AppendResult BoardStore::save_node(std::uint8_t node) {
  const AppendResult result = append_node(flash_, node);
  if (result == AppendResult::ok) {
    stored_.node = node;
  }
  return result;
}

}  // namespace proleg::firmware
