// What a viewer sends, one message a line, to a hub. A message is accepted, or the connection ends with a reason of one
// line; whatever is sent to the viewer is JSON, or rows.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/server/viewer_hub.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg::host;
using proleg::test::require;

class Session final : public RobotSession {
 public:
  void operate(const OperationRequest& request) override {
    require(request.arguments.is_object(), "arguments are an object");
    last = request.request;
  }
  void stop(const StopRequest& request) override { last_stop = request.request; }
  void holder_changed(bool /*has_holder*/, bool /*is_away*/) override {}

  RequestId last = 0;
  RequestId last_stop = 0;
};

void read_messages(ViewerHub& hub, ServerTime now, ClientId client) {
  while (const auto message = hub.next_message(now, client)) {
    if (message->is_binary) {
      require(message->bytes->size() > telemetry_header_bytes, "telemetry has a row");
    } else {
      require(nlohmann::json::accept(*message->bytes), "messages are JSON");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const AccessToken token = AccessToken::make();
  Session session;
  TickHistory history(1000);
  ViewerHub hub({"fuzz", {"look"}}, token, session, history);
  const SignalLayout layout({{"angle", "degree", 1, 2, SignalOf::joint}});
  hub.set_layout(layout, 10'000, history.reset(2));
  ServerTime now{1000};
  const ClientId other = hub.add_viewer(now);
  const ClientId client = hub.add_viewer(now);
  for (const ClientId viewer : {other, client}) {
    hub.receive(now, viewer, R"({"type":"hello","protocol":1,"name":"n","token":")" + token.text() + R"("})");
    require(!hub.closing(viewer), "a hello is accepted");
  }
  hub.receive(now, other, R"({"type":"operation","id":1,"name":"control.take"})");

  std::string line;
  std::uint32_t tick = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] != '\n' && i + 1 < size) {
      line.push_back(static_cast<char>(data[i]));
      continue;
    }
    hub.receive(now, client, line);
    hub.answer({session.last, true, nullptr, {}});
    hub.stopped({session.last_stop, 1, 1, 1});
    history.add(1, tick++, std::vector<std::int32_t>{1, 2});
    now += ServerTime(100);
    hub.advance(now);
    read_messages(hub, now, client);
    read_messages(hub, now, other);
    line.clear();
  }
  if (const auto closing = hub.closing(client)) {
    require(!closing->text.empty() && closing->text.size() <= 123, "a reason fits into a close frame");
    require(closing->text.find('\n') == std::string::npos, "a reason is one line");
  }
  require(!hub.closing(other), "other viewers stay connected");
  return 0;
}
