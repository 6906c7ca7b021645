#include "tools/proleg/ui/desktop_start.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace proleg::tools {
namespace {

using namespace std::chrono_literals;

TEST(LastPage, IsGoneAMinuteAfterItWasClosed) {
  const LastPage::Time start{};
  LastPage page(start);
  EXPECT_FALSE(page.is_gone(start + 30s, 0)) << "the browser starts";
  EXPECT_FALSE(page.is_gone(start + 50s, 2));
  EXPECT_FALSE(page.is_gone(start + 10h, 1));
  EXPECT_FALSE(page.is_gone(start + 10h + 60s, 0)) << "the page may be loaded again";
  EXPECT_TRUE(page.is_gone(start + 10h + 61s, 0));
}

TEST(LastPage, IsGoneIfNoneWasEverOpened) {
  const LastPage::Time start{};
  LastPage page(start);
  EXPECT_FALSE(page.is_gone(start + 60s, 0));
  EXPECT_TRUE(page.is_gone(start + 61s, 0));
}

}  // namespace
}  // namespace proleg::tools
