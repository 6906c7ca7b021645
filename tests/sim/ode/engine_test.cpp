#include "sim/ode/engine.hpp"

#include <gtest/gtest.h>

#include <ode/error.h>
#include <ode/odeinit.h>

#include <thread>

namespace proleg::sim {
namespace {

/// On a thread of its own, because messages are counted for each thread.
template <typename Action>
void on_thread(const Action& action) {
  std::thread([&] {
    action();
    dCleanupODEAllDataForThread();
  }).join();
}

TEST(Engine, KeepsTheTextsOfMessagesThatDiffer) {
  on_thread([] {
    prepare_engine_for_this_thread();
    for (int i = 0; i < 3; ++i) {
      dMessage(7, "LCP internal error, s <= 0 (s=%.1f)", 0.5);
    }
    dMessage(7, "LCP internal error, s <= 0 (s=%.1f)", 1.5);
    EXPECT_EQ(engine_messages(), 4U);
    ASSERT_EQ(engine_message_texts().size(), 2U);
    EXPECT_EQ(engine_message_texts()[0], "LCP internal error, s <= 0 (s=0.5)");
    EXPECT_EQ(engine_message_texts()[1], "LCP internal error, s <= 0 (s=1.5)");
  });
}

TEST(Engine, KeepsAFewTextsHoweverManyMessagesThereAre) {
  on_thread([] {
    prepare_engine_for_this_thread();
    for (int i = 0; i < 1000; ++i) {
      dMessage(7, "message %d", i);
    }
    EXPECT_EQ(engine_messages(), 1000U);
    EXPECT_EQ(engine_message_texts().size(), 10U);
  });
}

}  // namespace
}  // namespace proleg::sim
