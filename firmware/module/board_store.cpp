#include "firmware/module/board_store.hpp"

namespace proleg::firmware {

void BoardStore::load() {
  stored_ = newest(flash_.contents(0), flash_.contents(1)).value_or(BoardRecord{});
  reset();
}

AppendResult BoardStore::save(const BoardRecord& record) {
  const AppendResult result = append(flash_, record);
  if (result == AppendResult::ok) {
    stored_ = record;
  }
  return result;
}

}  // namespace proleg::firmware
