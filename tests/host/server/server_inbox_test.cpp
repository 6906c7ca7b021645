#include "host/server/session_link.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace proleg::host {
namespace {

TEST(ServerInbox, HasTheNewestTextOfEachDocumentInTheOrderOfChanges) {
  ServerInbox inbox;
  inbox.put_document("a", "1");
  inbox.put_document("b", "2");
  inbox.put_document("a", "3");
  const ServerInbox::Contents contents = inbox.take_contents();
  const std::vector<std::pair<std::string, std::string>> expected{{"b", "2"}, {"a", "3"}};
  EXPECT_EQ(contents.documents, expected);
  EXPECT_TRUE(inbox.take_contents().documents.empty());
}

TEST(ServerInbox, HasTheLastNotices) {
  ServerInbox inbox;
  for (int i = 0; i < 1000; ++i) {
    inbox.put_notice(NoticeLevel::info, std::to_string(i));
  }
  const ServerInbox::Contents contents = inbox.take_contents();
  ASSERT_EQ(contents.notices.size(), 200U);
  EXPECT_EQ(contents.notices.back().text, "999");
}

TEST(ServerInbox, WakesTheServerOnceUntilItLooks) {
  ServerInbox inbox;
  EXPECT_TRUE(inbox.claim_wake());
  EXPECT_FALSE(inbox.claim_wake());
  static_cast<void>(inbox.take_contents());
  EXPECT_TRUE(inbox.claim_wake());
}

TEST(ServerInbox, LosesNoAnswerBetweenTwoThreads) {
  constexpr RequestId count = 20'000;
  ServerInbox inbox;
  std::thread session([&inbox] {
    for (RequestId i = 0; i < count; ++i) {
      inbox.put_answer({i, true, nullptr, {}});
    }
  });
  RequestId next = 0;
  while (next < count) {
    for (const OperationAnswer& answer : inbox.take_contents().answers) {
      EXPECT_EQ(answer.request, next++);
    }
  }
  session.join();
}

}  // namespace
}  // namespace proleg::host
