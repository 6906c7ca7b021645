#include "host/server/shared_messages.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace proleg::host {
namespace {

/// The message that a viewer gets next, as "NAME REVISION VALUE"; empty if there is none.
std::string next(const DocumentStore& store, KnownRevisions& known) {
  const SharedText text = store.next(known);
  if (!text) {
    return {};
  }
  const auto message = nlohmann::json::parse(*text);
  EXPECT_EQ(message["type"], "document");
  return message["name"].get<std::string>() + " " + message["revision"].dump() + " " + message["value"].dump();
}

TEST(DocumentStore, GivesEachDocumentOnce) {
  DocumentStore store;
  store.publish("robot", R"({"joints":5})");
  store.publish("session", "[]");
  KnownRevisions known;
  EXPECT_EQ(next(store, known), R"(robot 1 {"joints":5})");
  EXPECT_EQ(next(store, known), "session 2 []");
  EXPECT_EQ(next(store, known), "");
  store.publish("robot", "null");
  EXPECT_EQ(next(store, known), "robot 3 null");
  EXPECT_EQ(next(store, known), "");
}

TEST(DocumentStore, GivesOnlyTheNewestRevision) {
  DocumentStore store;
  KnownRevisions known;
  for (int i = 0; i < 1000; ++i) {
    store.publish("session", std::to_string(i));
  }
  EXPECT_EQ(next(store, known), "session 1000 999");
  EXPECT_EQ(next(store, known), "");
}

TEST(DocumentStore, ADocumentThatChangesAllTheTimeDelaysNoOther) {
  DocumentStore store;
  KnownRevisions known;
  store.publish("a", "1");
  store.publish("b", "1");
  store.publish("a", "2");
  EXPECT_EQ(next(store, known), "b 2 1");
  store.publish("c", "1");
  store.publish("a", "3");
  EXPECT_EQ(next(store, known), "c 4 1");
  EXPECT_EQ(next(store, known), "a 5 3");
}

TEST(DocumentStore, SharesTheMessageAmongViewers) {
  DocumentStore store;
  store.publish("a", "1");
  KnownRevisions first;
  KnownRevisions second;
  EXPECT_EQ(store.next(first), store.next(second));
}

}  // namespace
}  // namespace proleg::host
