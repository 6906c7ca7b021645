#include "sim/ode/step_memory.hpp"

#include <cstdlib>

namespace proleg::sim {
namespace {

thread_local StepMemory* selected = nullptr;

}  // namespace

StepMemory::~StepMemory() {
  for (Header* const header : blocks_) {
    std::free(header);
  }
  if (selected == this) {
    selected = nullptr;
  }
}

void StepMemory::use_for(dWorldID world) {
  const dWorldStepMemoryFunctionsInfo functions{sizeof(dWorldStepMemoryFunctionsInfo), allocate, shrink, release};
  dWorldSetStepMemoryManager(world, &functions);
}

void StepMemory::select() { selected = this; }

// The engine handles the absence of a block.
void* StepMemory::allocate(std::size_t size) {
  auto* const header = static_cast<Header*>(std::malloc(sizeof(Header) + size));
  if (header == nullptr) {
    return nullptr;
  }
  header->owner = selected;
  selected->blocks_.push_back(header);
  return header + 1;
}

void* StepMemory::shrink(void* block, std::size_t /*size*/, std::size_t /*smaller*/) { return block; }

void StepMemory::release(void* block, std::size_t /*size*/) {
  Header* const header = static_cast<Header*>(block) - 1;
  std::erase(header->owner->blocks_, header);
  std::free(header);
}

}  // namespace proleg::sim
