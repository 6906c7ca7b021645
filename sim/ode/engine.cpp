#include "sim/ode/engine.hpp"

#include <ode/ode.h>
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <utility>
#include <vector>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim {
namespace {

thread_local std::size_t message_count = 0;
thread_local std::vector<std::string> message_texts;

std::string text_of(const char* format, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  return text.data();
}

void keep_message(int /*number*/, const char* format, va_list arguments) {
  constexpr std::size_t max_texts = 10;
  ++message_count;
  if (message_texts.size() < max_texts) {
    if (std::string text = text_of(format, arguments); std::ranges::find(message_texts, text) == message_texts.end()) {
      message_texts.push_back(std::move(text));
    }
  }
}

// The engine ends the process when this returns; an exception is the only way out.
[[noreturn]] void raise_error(int number, const char* format, va_list arguments) {
  throw PhysicsError("the physics engine reports error " + std::to_string(number) + ": " + text_of(format, arguments));
}

thread_local StepMemory* selected = nullptr;

std::mutex* shared_lock = nullptr;

/// Never destroyed: threads may simulate while the program ends. fork() waits for the end of a step, so that the child
/// has the engine between two steps, and a lock that is free.
std::mutex& own_lock() {
  static auto* const lock = [] {
    static auto* const made = new std::mutex;
    pthread_atfork([] { made->lock(); }, [] { made->unlock(); }, [] { made->unlock(); });
    return made;
  }();
  return *lock;
}

}  // namespace

std::mutex& SolverRandomNumbers::lock() { return shared_lock != nullptr ? *shared_lock : own_lock(); }
void SolverRandomNumbers::use_lock(std::mutex& lock) { shared_lock = &lock; }

void SolverRandomNumbers::quick_step(dWorldID world, double step_s) {
  const std::lock_guard turn(lock());
  dRandSetSeed(state_);
  dWorldQuickStep(world, step_s);
  state_ = dRandGetSeed();
}

void prepare_engine_for_this_thread() {
  static std::once_flag once;
  std::call_once(once, [] {
    dInitODE2(0);
    dSetMessageHandler(keep_message);
    dSetErrorHandler(raise_error);
    dSetDebugHandler(raise_error);
  });
  dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
}

std::size_t engine_messages() { return message_count; }

std::span<const std::string> engine_message_texts() { return message_texts; }

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
