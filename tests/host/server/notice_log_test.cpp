#include "host/server/shared_messages.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace proleg::host {
namespace {

TEST(NoticeLog, GivesEachNoticeOnceAndInOrder) {
  NoticeLog log;
  log.add(NoticeLevel::info, "one");
  log.add(NoticeLevel::error, "two");
  std::uint64_t number = 0;
  EXPECT_EQ(nlohmann::json::parse(*log.next(number)),
            nlohmann::json::parse(R"({"type": "notice", "number": 0, "level": "info", "text": "one"})"));
  EXPECT_EQ(nlohmann::json::parse(*log.next(number))["level"], "error");
  EXPECT_EQ(log.next(number), nullptr);
  log.add(NoticeLevel::warning, "three");
  EXPECT_EQ(nlohmann::json::parse(*log.next(number))["text"], "three");
  EXPECT_EQ(log.next(number), nullptr);
}

TEST(NoticeLog, KeepsTheLastTwoHundred) {
  NoticeLog log;
  for (int i = 0; i < 1000; ++i) {
    log.add(NoticeLevel::info, std::to_string(i));
  }
  std::uint64_t number = 0;
  std::vector<std::string> texts;
  while (const SharedText text = log.next(number)) {
    texts.push_back(nlohmann::json::parse(*text)["text"]);
  }
  ASSERT_EQ(texts.size(), 200U);
  EXPECT_EQ(texts.front(), "800");
  EXPECT_EQ(texts.back(), "999");
}

TEST(NoticeLog, ReplacesWhatIsNotText) {
  EXPECT_EQ(nlohmann::json::parse(notice_message(NoticeLevel::info,
                                                 "a\xff"
                                                 "b"))["text"],
            "a\uFFFDb");
}

}  // namespace
}  // namespace proleg::host
