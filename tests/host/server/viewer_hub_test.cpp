#include "host/server/viewer_hub.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <regex>

#include "decoded_rows.hpp"
#include "tests/support/files.hpp"

namespace proleg::host {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class RecordingSession final : public RobotSession {
 public:
  void operate(const OperationRequest& request) override { operations.push_back(request); }
  void stop(const StopRequest& request) override { stops.push_back(request); }
  void holder_changed(bool has_holder, bool is_away) override {
    holders.push_back(std::string(has_holder ? "held" : "free") + (is_away ? ", away" : ""));
  }

  std::vector<OperationRequest> operations;
  std::vector<StopRequest> stops;
  std::vector<std::string> holders;
};

class Hub : public testing::Test {
 protected:
  explicit Hub(NewViewers gives_control = NewViewers::none)
      : hub({"proleg 1", {"look"}, gives_control}, token, session, history) {}
  ClientId join(const std::string& name, const json& more = json::object()) {
    const ClientId client = hub.add_viewer(now);
    json hello{{"type", "hello"}, {"protocol", 1}, {"token", token.text()}, {"name", name}};
    hello.update(more);
    send(client, hello);
    return client;
  }
  void send(ClientId client, const json& message) { hub.receive(now, client, message.dump()); }
  void operate(ClientId client, std::uint64_t id, const std::string& name, std::uint64_t epoch = 0,
               const json& arguments = json::object()) {
    send(client, {{"type", "operation"}, {"id", id}, {"epoch", epoch}, {"name", name}, {"arguments", arguments}});
  }
  /// All text messages that a viewer can get now; the number of binary ones is in `binaries`.
  std::vector<json> received(ClientId client) {
    std::vector<json> messages;
    binaries.clear();
    while (const auto message = hub.next_message(now, client)) {
      if (message->is_binary) {
        binaries.emplace_back(*message->bytes);
      } else {
        messages.push_back(json::parse(*message->bytes));
      }
    }
    return messages;
  }
  /// The last message of a type; null if there is none.
  json last(ClientId client, const std::string& type) {
    json found;
    for (const json& message : received(client)) {
      if (message["type"] == type) {
        found = message;
      }
    }
    return found;
  }
  std::string close_reason(ClientId client) const {
    const auto closing = hub.closing(client);
    return closing ? std::to_string(closing->code) + " " + closing->text : "";
  }
  void set_signals(std::size_t joints) {
    const SignalLayout layout({{"angle", "", 1, joints, SignalOf::joint}});
    hub.set_layout(layout, 10'000, history.reset(layout.row_size()));
  }
  void add_rows(std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t tick = first; tick < first + count; ++tick) {
      history.add(1, tick, std::vector<std::int32_t>(5, static_cast<std::int32_t>(tick)));
    }
  }

  const AccessToken token = AccessToken::make();
  RecordingSession session;
  TickHistory history{1 << 20};
  ViewerHub hub;
  ServerTime now = 1h;
  std::vector<DecodedRows> binaries;
};

TEST_F(Hub, GreetsAViewerAndSendsEveryDocument) {
  hub.publish("robot", "5");
  hub.notice(NoticeLevel::info, "ready");
  const std::vector<json> messages = received(join("desk"));
  ASSERT_EQ(messages.size(), 4U);
  EXPECT_EQ(messages[0], json::parse(R"({"type": "welcome", "protocol": 1, "client": 1, "program": "proleg 1",
                                      "next_notice": 1})"));
  EXPECT_EQ(messages[1]["name"], "control");
  EXPECT_EQ(messages[2]["name"], "robot");
  EXPECT_EQ(messages[3]["text"], "ready");
  EXPECT_EQ(messages[3]["number"], 0);
  hub.notice(NoticeLevel::info, "steady");
  EXPECT_EQ(last(join("another desk"), "welcome")["next_notice"], 2);
}

/// The first number that the expression finds in a file of the source tree; 0 if it finds none.
int number_in_source(const std::string& below, const std::string& expression) {
  const std::string text = file_contents(source_path(below));
  std::smatch found;
  return std::regex_search(text, found, std::regex(expression)) ? std::stoi(found[1]) : 0;
}

TEST_F(Hub, HasTheProtocolOfThePageAndOfItsDocumentation) {
  const int of_page = number_in_source("/host/page/source/wire/messages.ts", R"(export const protocol = (\d+);)");
  EXPECT_EQ(number_in_source("/docs/page-interface.md", R"("type": "hello", "protocol": (\d+))"), of_page);
  EXPECT_EQ(number_in_source("/docs/page-interface.md", R"("type": "welcome", "protocol": (\d+))"), of_page);
  const ClientId client = join("desk", {{"protocol", of_page}});
  EXPECT_EQ(close_reason(client), "");
  EXPECT_EQ(last(client, "welcome")["protocol"], of_page);
}

TEST_F(Hub, ToAViewerWithoutHelloSendsNothing) {
  const ClientId client = hub.add_viewer(now);
  EXPECT_TRUE(received(client).empty());
  EXPECT_EQ(hub.deadline(now), now + 2s);
  hub.advance(now + 1'999ms);
  EXPECT_EQ(close_reason(client), "");
  hub.advance(now + 2s);
  EXPECT_EQ(close_reason(client), "1008 found no hello within 2 s, expected one as the first message");
}

TEST_F(Hub, IgnoresWhatComesAfterAViolation) {
  const ClientId client = hub.add_viewer(now);
  send(client, {{"type", "hello"}, {"protocol", 1}, {"token", "wrong"}, {"name", "x"}});
  EXPECT_EQ(close_reason(client),
            "1008 hello: found a wrong token, expected that of the address that proleg ui printed");
  send(client, {{"type", "hello"}, {"protocol", 1}, {"token", token.text()}, {"name", "x"}});
  send(client, {{"type", "stop"}});
  EXPECT_TRUE(session.stops.empty());
  EXPECT_TRUE(received(client).empty());
}

TEST_F(Hub, CutsReasonsToWhatACloseFrameHolds) {
  const ClientId client = join("desk");
  std::string signal;
  for (int i = 0; i < 1000; ++i) {
    signal += "\u00e4";
  }
  send(client, {{"type", signal}});
  const std::string reason = hub.closing(client).value().text;
  EXPECT_LE(reason.size(), 123U);
  EXPECT_GE(reason.size(), 120U);
  EXPECT_NO_THROW(json(reason).dump()) << "no character is cut in two";
}

TEST_F(Hub, PassesOperationsOnAndAnswersThem) {
  const ClientId client = join("desk");
  operate(client, 3, "look", 0, {{"at", "J1"}});
  ASSERT_EQ(session.operations.size(), 1U);
  EXPECT_EQ(session.operations[0].name, "look");
  EXPECT_EQ(session.operations[0].arguments, json({{"at", "J1"}}));
  EXPECT_EQ(session.operations[0].client_name, "desk");
  EXPECT_EQ(last(client, "result"), nullptr) << "until the session answers";
  hub.answer({session.operations[0].request, true, json{{"tick", 7}}, {}});
  EXPECT_EQ(last(client, "result"), json::parse(R"({"type": "result", "id": 3, "ok": true, "value": {"tick": 7}})"));
  hub.answer({session.operations[0].request, true, nullptr, {}});
  EXPECT_EQ(last(client, "result"), nullptr) << "only the first answer counts";
  operate(client, 4, "look");
  hub.answer({session.operations[1].request, false, nullptr, "too dark"});
  EXPECT_EQ(last(client, "result"), json::parse(R"({"type": "result", "id": 4, "ok": false, "error": "too dark"})"));
}

TEST_F(Hub, PassesNoOperationOnThatTheLeaseRefuses) {
  const ClientId anna = join("Anna");
  const ClientId ben = join("Ben");
  operate(anna, 1, "walk");
  EXPECT_EQ(last(anna, "result")["error"], "nobody has control: take it first");
  operate(anna, 2, "control.take");
  EXPECT_EQ(last(anna, "result")["value"], json({{"epoch", 1}}));
  operate(ben, 1, "walk", 1);
  EXPECT_EQ(last(ben, "result")["error"], "control is with Anna");
  EXPECT_TRUE(session.operations.empty());
  operate(anna, 3, "walk", 1);
  EXPECT_EQ(session.operations.size(), 1U);
}

class LocalHub : public Hub {
 protected:
  LocalHub() : Hub(NewViewers::alone) {}
  ClientId join_to_drive(const std::string& name) { return join(name, {{"wants_control", true}}); }
  /// The name of the viewer that drives, as another one reads it; null: nobody.
  json holder(ClientId client) {
    for (const json& message : received(client)) {
      if (message["type"] == "document" && message["name"] == "control") {
        driver = message["value"]["holder"].is_null() ? json() : message["value"]["holder"]["name"];
      }
    }
    return driver;
  }

  json driver;
};

TEST_F(LocalHub, GivesControlToAViewerThatConnectsAloneAndWantsIt) {
  const ClientId anna = join_to_drive("Anna");
  EXPECT_EQ(holder(anna), "Anna");
  operate(anna, 1, "walk", 1);
  EXPECT_EQ(session.operations.size(), 1U);
  EXPECT_EQ(session.holders, (std::vector<std::string>{"held"}));
}

TEST_F(LocalHub, GivesNoControlToAViewerThatDoesNotAskForIt) {
  const ClientId script = join("a script that looks on");
  const ClientId stop = join("stop", {{"only", "stop"}, {"wants_control", true}});
  EXPECT_EQ(holder(script), nullptr);
  hub.remove_viewer(now, script);
  EXPECT_EQ(holder(stop), nullptr);
  EXPECT_TRUE(session.holders.empty());
}

TEST_F(LocalHub, GivesNoControlBesideAnotherViewer) {
  const ClientId script = join("a script that looks on");
  const ClientId anna = join_to_drive("Anna");
  EXPECT_EQ(holder(anna), nullptr);
  hub.remove_viewer(now, script);
  hub.advance(now += 1h);
  EXPECT_EQ(holder(anna), nullptr) << "only the moment of connecting counts";
  const ClientId ben = join_to_drive("Ben");
  EXPECT_EQ(holder(ben), nullptr);
}

TEST_F(LocalHub, GivesControlBesideAConnectionForStopAloneOrOneThatIsNoViewer) {
  join("stop", {{"only", "stop"}});
  static_cast<void>(hub.add_viewer(now));
  const ClientId refused = hub.add_viewer(now);
  send(refused, {{"type", "hello"}, {"protocol", 1}, {"token", "wrong"}, {"name", "x"}, {"wants_control", true}});
  EXPECT_TRUE(session.holders.empty());
  EXPECT_EQ(holder(join_to_drive("Anna")), "Anna");
}

TEST_F(LocalHub, GivesControlAgainAfterAReload) {
  const ClientId before = join_to_drive("Anna");
  hub.remove_viewer(now, before);
  const ClientId after = join_to_drive("Anna");
  operate(after, 1, "walk", 2);
  EXPECT_EQ(session.operations.size(), 1U);
  EXPECT_EQ(session.holders, (std::vector<std::string>{"held", "free", "held"})) << "what was held down is let go";
  hub.close(after, 1008, "the connection is about to end");
  EXPECT_EQ(holder(join_to_drive("Ben")), "Anna") << "until the connection before has ended";
}

TEST_F(Hub, GivesNoControlIfTheServerDoesNotAllowIt) {
  join("Anna", {{"wants_control", true}});
  EXPECT_TRUE(session.holders.empty());
}

TEST_F(Hub, TellsTheSessionWhetherSomebodyDrives) {
  const ClientId anna = join("Anna");
  operate(anna, 1, "control.take");
  hub.advance(now += 1s);
  send(anna, {{"type", "beat"}, {"age_ms", 1}});
  hub.remove_viewer(now, anna);
  EXPECT_EQ(session.holders, (std::vector<std::string>{"held", "held, away", "held", "free"}));
}

TEST_F(Hub, TakesAnOperationOfTheHolderAsASignOfLife) {
  const ClientId anna = join("Anna");
  const ClientId ben = join("Ben");
  operate(anna, 1, "control.take");
  hub.advance(now += 1s);
  operate(ben, 1, "walk", 1);
  operate(anna, 2, "walk", 0);
  operate(anna, 3, "look");
  EXPECT_EQ(session.holders.back(), "held, away") << "these are not the holder's: refused, or free for everybody";
  operate(anna, 4, "walk", 1);
  EXPECT_EQ(session.holders.back(), "held");
  hub.advance(now += 1s);
  EXPECT_EQ(session.holders.back(), "held, away");
}

TEST_F(Hub, RefusesOperationsOnControlThatItDoesNotKnow) {
  const ClientId anna = join("Anna");
  operate(anna, 1, "control.steal");
  EXPECT_EQ(last(anna, "result")["error"],
            "found operation 'control.steal', expected control.take, control.answer or control.release");
  operate(anna, 2, "control.answer", 0, {{"grant", 1}});
  EXPECT_EQ(last(anna, "result")["error"], "control.answer: found no 'grant', expected true or false");
}

TEST_F(Hub, LetsEverybodyStopAndAnswersBeforeAnythingElse) {
  const ClientId client = join("desk");
  send(client, {{"type", "stop"}});
  ASSERT_EQ(session.stops.size(), 1U);
  EXPECT_EQ(session.stops[0].by, "desk");
  received(client);
  hub.publish("robot", "1");
  hub.stopped({session.stops[0].request, 4, 5, 3.5});
  EXPECT_EQ(received(client)[0], json::parse(R"({"type": "stopped", "confirmed": 4, "of": 5, "ms": 3.5})"));
  hub.stop("POST /stop");
  EXPECT_EQ(session.stops[1].by, "POST /stop");
  hub.stopped({session.stops[1].request, 5, 5, 1});
  EXPECT_TRUE(received(client).empty());
}

TEST_F(Hub, PassesEveryStopOnAlsoIfNoneIsAnswered) {
  const ClientId client = join("desk");
  for (int i = 0; i < 5000; ++i) {
    send(client, {{"type", "stop"}});
  }
  EXPECT_EQ(session.stops.size(), 5000U);
  hub.stopped({session.stops.back().request, 5, 5, 1});
  EXPECT_NE(last(client, "stopped"), nullptr);
}

TEST_F(Hub, LeavesAConnectionForStopAlone) {
  const ClientId client = join("stop", {{"only", "stop"}});
  set_signals(5);
  hub.notice(NoticeLevel::info, "ready");
  EXPECT_EQ(received(client).size(), 1U) << "the welcome";
  send(client, {{"type", "stop"}});
  hub.stopped({session.stops[0].request, 5, 5, 1});
  EXPECT_EQ(received(client).size(), 1U);
}

TEST_F(Hub, RefusesTheSixtyFifthPendingOperation) {
  const ClientId client = join("desk");
  for (std::uint64_t id = 0; id < 65; ++id) {
    operate(client, id, "look");
  }
  EXPECT_EQ(session.operations.size(), 64U);
  const json refused = last(client, "result");
  EXPECT_EQ(refused["id"], 64);
  EXPECT_EQ(refused["error"], "too many operations at once");
  hub.answer({session.operations[0].request, true, nullptr, {}});
  operate(client, 65, "look");
  EXPECT_EQ(session.operations.size(), 64U) << "an answer that is not sent yet counts";
  received(client);
  operate(client, 66, "look");
  EXPECT_EQ(session.operations.size(), 65U);
}

TEST_F(Hub, SendsAnAnswerInBytesAsABinaryMessage) {
  const ClientId client = join("desk");
  received(client);
  constexpr std::uint64_t id = 0x0102030405ULL;
  operate(client, id, "look");
  hub.answer({session.operations[0].request, true, json::binary({7, 8, 0, 9}), {}});
  const auto message = hub.next_message(now, client);
  ASSERT_TRUE(message);
  EXPECT_TRUE(message->is_binary);
  EXPECT_EQ(*message->bytes, std::string("\0\0\0\0\0\0\0\0\5\4\3\2\1\0\0\0\7\10\0\11", 20));
  EXPECT_FALSE(hub.next_message(now, client));
}

TEST_F(Hub, KeepsFewAnswersInBytesForAViewerThatDoesNotRead) {
  const ClientId client = join("desk");
  received(client);
  const std::vector<std::uint8_t> bytes(3U << 20U);
  const auto ask = [&](std::uint64_t id) {
    operate(client, id, "look");
    hub.answer({session.operations.back().request, true, json::binary(bytes), {}});
  };
  for (std::uint64_t id = 0; id < 20; ++id) {
    ask(id);
  }
  std::size_t sent = 0;
  std::size_t refused = 0;
  while (const auto message = hub.next_message(now, client)) {
    sent += message->is_binary ? message->bytes->size() : 0;
    refused += message->is_binary ? 0 : 1;
    EXPECT_TRUE(message->is_binary ||
                json::parse(*message->bytes)["error"] == "too many answers in bytes wait to be sent");
  }
  EXPECT_LE(sent, (8U << 20U) + 64);
  EXPECT_GT(sent, 0U);
  EXPECT_EQ(refused, 18U);
  ask(20);
  const auto message = hub.next_message(now, client);
  EXPECT_TRUE(message && message->is_binary) << "after it has read, it gets the next one";
}

TEST_F(Hub, EndsTheConnectionOfAViewerThatAsksAndDoesNotRead) {
  const ClientId client = join("desk");
  for (std::uint64_t id = 0; id < 400; ++id) {
    operate(client, id, "walk");
  }
  EXPECT_EQ(close_reason(client), "1008 found 256 replies that were not read, expected a viewer that reads");
}

TEST_F(Hub, ForgetsTheOperationsOfAViewerThatHasGone) {
  const ClientId anna = join("Anna");
  operate(anna, 1, "look");
  hub.remove_viewer(now, anna);
  const ClientId ben = join("Ben");
  EXPECT_NE(ben, anna);
  received(ben);
  hub.answer({session.operations[0].request, true, nullptr, {}});
  EXPECT_TRUE(received(ben).empty());
}

TEST_F(Hub, SendsTelemetryToWhoAsksForIt) {
  set_signals(5);
  const ClientId client = join("desk");
  add_rows(0, 10);
  received(client);
  EXPECT_TRUE(binaries.empty());
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}});
  received(client);
  EXPECT_TRUE(binaries.empty()) << "from now on";
  add_rows(10, 3);
  received(client);
  ASSERT_EQ(binaries.size(), 1U);
  EXPECT_EQ(binaries[0].tick, 10U);
  EXPECT_EQ(binaries[0].rows, 3U);
}

TEST_F(Hub, SendsTheNewestRowToWhoHasNone) {
  set_signals(5);
  const ClientId client = join("desk");
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}, {"newest", true}});
  received(client);
  EXPECT_TRUE(binaries.empty()) << "there is none";
  add_rows(0, 10);
  received(client);
  ASSERT_EQ(binaries.size(), 1U);
  EXPECT_EQ(binaries[0].flags, 0U);
  // Another one comes when the robot stands still.
  const ClientId late = join("sofa");
  now += 8ms;
  send(late, {{"type", "subscribe"}, {"signals", {"angle"}}, {"newest", true}});
  received(late);
  ASSERT_EQ(binaries.size(), 1U);
  EXPECT_EQ(binaries[0].tick, 9U);
  EXPECT_EQ(binaries[0].rows, 1U);
}

TEST_F(Hub, SendsFastTicksTogether) {
  set_signals(5);
  const ClientId client = join("desk");
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}});
  received(client);
  add_rows(0, 1);
  received(client);
  EXPECT_EQ(binaries.size(), 1U);
  EXPECT_EQ(hub.deadline(now), no_deadline) << "nothing is unread";
  add_rows(1, 4);
  EXPECT_EQ(hub.deadline(now), now + 8ms);
  received(client);
  EXPECT_TRUE(binaries.empty());
  now += 8ms;
  received(client);
  ASSERT_EQ(binaries.size(), 1U);
  EXPECT_EQ(binaries[0].rows, 4U);
}

TEST_F(Hub, SendsTheLastTickOfAFastRunThatHasPaused) {
  set_signals(5);
  const ClientId client = join("desk");
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}});
  std::uint32_t tick = 0;
  for (; tick < 4001; tick += 30) {
    add_rows(tick, 30);
    now += 8ms;
    hub.advance(now);
    received(client);
  }
  ASSERT_GT(binaries.back().stride, 1U);
  for (auto deadline = hub.deadline(now); deadline != no_deadline; deadline = hub.deadline(now)) {
    ASSERT_LE(deadline, now + 8ms);
    now = deadline;
    hub.advance(now);
    received(client);
  }
  const auto& last = binaries.back();
  EXPECT_EQ(last.tick + (last.rows - 1U) * last.stride, tick - 1U);
}

TEST_F(Hub, DoesNotDelayDocumentsForTelemetryNorTheReverse) {
  set_signals(5);
  const ClientId client = join("desk");
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}});
  received(client);
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    add_rows(tick, 1);
    hub.publish("robot", "1");
    hub.publish("session", "1");
    now += 8ms;
    const auto first = hub.next_message(now, client);
    const auto second = hub.next_message(now, client);
    ASSERT_TRUE(first && second);
    EXPECT_NE(first->is_binary, second->is_binary);
    received(client);
  }
}

TEST_F(Hub, RefusesASubscriptionWithAnUnknownSignal) {
  set_signals(5);
  const ClientId client = join("desk");
  send(client, {{"type", "subscribe"}, {"signals", {"angle", "angel"}}});
  add_rows(0, 1);
  bool has_notice = false;
  for (const json& message : received(client)) {
    has_notice = has_notice ||
                 message.value("text", "") == "subscribe: found 'angel', expected a signal of the document 'telemetry'";
  }
  EXPECT_TRUE(has_notice);
  EXPECT_TRUE(binaries.empty());
}

TEST_F(Hub, EndsSubscriptionsWithTheLayout) {
  set_signals(5);
  const ClientId client = join("desk");
  const std::uint64_t old = last(client, "document")["value"]["hash"];
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}, {"hash", old}});
  set_signals(6);
  const json document = last(client, "document");
  EXPECT_EQ(document["name"], "telemetry");
  const auto add_row = [this] { history.add(1, 0, std::vector<std::int32_t>(6)); };
  add_row();
  received(client);
  EXPECT_TRUE(binaries.empty());
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}, {"hash", old}});
  add_row();
  received(client);
  EXPECT_TRUE(binaries.empty());
  send(client, {{"type", "subscribe"}, {"signals", {"angle"}}, {"hash", document["value"]["hash"]}});
  add_row();
  received(client);
  ASSERT_EQ(binaries.size(), 1U);
  EXPECT_EQ(binaries[0].subscription, 3U);
  EXPECT_EQ(binaries[0].values.size(), 6U);
}

class SeatHub : public Hub {
 protected:
  SeatHub() : Hub(NewViewers::any) {}
  json wish() const { return {{"wants_control", true}}; }
  json holder(ClientId client) {
    for (const json& message : received(client)) {
      if (message["type"] == "document" && message["name"] == "control") {
        control_ = message["value"];
      }
    }
    return control_["holder"].is_null() ? json() : control_["holder"]["client"];
  }

 private:
  json control_;
};

TEST_F(SeatHub, ALearnerDrivesAlthoughATeacherLooksOn) {
  const ClientId teacher = join("Teacher");
  const ClientId learner = join("Anna", wish());
  EXPECT_EQ(holder(teacher), json(learner));
}

TEST_F(SeatHub, AnotherViewerTakesNothingFromALearnerWhoIsThere) {
  const ClientId learner = join("Anna", wish());
  static_cast<void>(join("Anna again", wish()));
  EXPECT_EQ(holder(learner), json(learner));
}

TEST_F(SeatHub, ALearnerWhoseComputerSleptDrivesAgain) {
  const ClientId before = join("Anna", wish());
  now += ControlLease::away_timeout;
  hub.advance(now);
  const ClientId after = join("Anna", wish());
  EXPECT_EQ(holder(after), json(after)) << "the connection " << before << " has given no sign of life";
}

TEST_F(Hub, AStopThatNoViewerMadeIsAnsweredToWhoMadeIt) {
  std::vector<unsigned> answers;
  hub.stop("your teacher", [&](const StopAnswer& answer) { answers = {answer.confirmed, answer.of}; });
  ASSERT_EQ(session.stops.size(), 1U);
  EXPECT_EQ(session.stops.front().by, "your teacher");
  hub.stopped({session.stops.front().request, 4, 5, 1.0});
  EXPECT_EQ(answers, (std::vector<unsigned>{4, 5}));
  answers.clear();
  hub.stopped({session.stops.front().request, 4, 5, 1.0});
  EXPECT_TRUE(answers.empty()) << "one answer for each STOP";
}

}  // namespace
}  // namespace proleg::host
