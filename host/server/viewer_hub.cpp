#include "host/server/viewer_hub.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using nlohmann::json;

constexpr std::uint64_t protocol = 1;

}  // namespace

ViewerHub::ViewerHub(Options options, const AccessToken& token, RobotSession& session, TickHistory& history)
    : options_(std::move(options)), token_(token), session_(session), state_{{}, {}, history, {}} {
  report_lease({});
}

Viewer* ViewerHub::find(ClientId client) {
  const auto found = viewers_.find(client);
  return found == viewers_.end() ? nullptr : &found->second;
}

ClientId ViewerHub::add_viewer(ServerTime now) {
  ++last_client_;
  viewers_.try_emplace(last_client_, last_client_, now);
  return last_client_;
}

void ViewerHub::remove_viewer(ServerTime now, ClientId client) {
  viewers_.erase(client);
  std::erase_if(operations_, [client](const auto& entry) { return entry.second.client == client; });
  std::erase_if(stops_, [client](const auto& entry) { return entry.second == client; });
  lease_.leave(now, client);
  report_lease(now);
}

void ViewerHub::close(ClientId client, std::uint16_t code, const std::string& reason) {
  if (Viewer* const viewer = find(client)) {
    viewer->close(code, reason);
  }
}

std::optional<CloseReason> ViewerHub::closing(ClientId client) const {
  const auto found = viewers_.find(client);
  return found == viewers_.end() ? std::nullopt : found->second.closing();
}

void ViewerHub::receive(ServerTime now, ClientId client, std::string_view text) {
  Viewer* const viewer = find(client);
  if (viewer == nullptr || viewer->closing()) {
    return;
  }
  try {
    const ClientMessage message = parse_client_message(text);
    if (viewer->is_welcome() == std::holds_alternative<Hello>(message)) {
      viewer->close(1008, viewer->is_welcome() ? "message: found a second hello, expected another message"
                                               : "message: found no hello, expected it as the first message");
      return;
    }
    std::visit([&](const auto& content) { handle(now, *viewer, content); }, message);
  } catch (const InputError& error) {
    viewer->close(1008, error.what());
  }
}

void ViewerHub::handle(ServerTime now, Viewer& viewer, const Hello& hello) {
  if (!token_.matches(hello.token)) {
    viewer.close(1008, "hello: found a wrong token, expected that of the address that proleg ui printed");
  } else if (hello.protocol != protocol) {
    viewer.close(1008,
                 "hello: found protocol " + std::to_string(hello.protocol) + ", expected " + std::to_string(protocol));
  } else {
    viewer.welcome(hello.name, hello.is_only_stop, options_.program, state_.notices.next_number());
    const bool may_have_control = options_.gives_control == NewViewers::any ||
                                  (options_.gives_control == NewViewers::alone && is_alone(viewer.client()));
    if (may_have_control && hello.wants_control && !hello.is_only_stop) {
      lease_.give(now, viewer.client(), viewer.name());
      report_lease(now);
    }
  }
}

bool ViewerHub::is_alone(ClientId client) const {
  return std::ranges::none_of(viewers_, [client](const auto& entry) {
    const auto& [other, viewer] = entry;
    return other != client && viewer.is_welcome() && !viewer.is_only_stop();
  });
}

void ViewerHub::handle(ServerTime now, Viewer& viewer, const Operation& operation) {
  if (!viewer.begin_operation(operation.id)) {
    return;
  }
  if (operation.name.starts_with("control.")) {
    control(now, viewer, operation);
    return;
  }
  lease_.advance(now);
  if (!options_.free_operations.contains(operation.name)) {
    const std::string refusal = lease_.refusal(viewer.client(), operation.epoch);
    if (!refusal.empty()) {
      viewer.finish_operation(operation.id, false, nullptr, refusal);
      return;
    }
    // Else a robot that starts right after the page was silent would stop before the next beat comes.
    lease_.beat(now, viewer.client(), 0);
    report_lease(now);
  }
  const RequestId request = ++last_request_;
  operations_[request] = {viewer.client(), operation.id};
  session_.operate({request, operation.name, operation.arguments, viewer.client(), viewer.name()});
}

void ViewerHub::control(ServerTime now, Viewer& viewer, const Operation& operation) {
  if (operation.name == "control.take") {
    lease_.take(now, viewer.client(), viewer.name(), operation.id);
  } else if (operation.name == "control.release") {
    lease_.release(now, viewer.client(), operation.epoch, operation.id);
  } else if (operation.name == "control.answer") {
    const auto grant = operation.arguments.find("grant");
    if (grant == operation.arguments.end() || !grant->is_boolean()) {
      viewer.finish_operation(operation.id, false, nullptr, "control.answer: found no 'grant', expected true or false");
      return;
    }
    lease_.answer(now, viewer.client(), operation.epoch, operation.id, grant->get<bool>());
  } else {
    viewer.finish_operation(
        operation.id, false, nullptr,
        "found operation " + in_quotes(operation.name) + ", expected control.take, control.answer or control.release");
  }
  report_lease(now);
}

void ViewerHub::handle(ServerTime /*now*/, Viewer& viewer, const Stop& /*stop*/) {
  const RequestId request = ++last_request_;
  // Every STOP reaches the session, also if it has not answered earlier ones. Only its answer may be forgotten.
  if (stops_.size() >= max_pending_stops) {
    stops_.erase(stops_.begin());
  }
  stops_[request] = viewer.client();
  session_.stop({request, viewer.name()});
}

void ViewerHub::stop(const std::string& by, std::function<void(const StopAnswer&)> answered) {
  const RequestId request = ++last_request_;
  if (answered) {
    if (other_stops_.size() >= max_pending_stops) {
      other_stops_.erase(other_stops_.begin());
    }
    other_stops_.emplace(request, std::move(answered));
  }
  session_.stop({request, by});
}

void ViewerHub::handle(ServerTime now, Viewer& viewer, const Beat& beat) {
  lease_.beat(now, viewer.client(), beat.age_ms);
  report_lease(now);
}

void ViewerHub::handle(ServerTime /*now*/, Viewer& viewer, const Subscribe& subscribe) {
  Subscription subscription{viewer.next_subscription_number(), generation_, {}};
  viewer.set_subscription(std::nullopt, state_.history);
  if (generation_ == 0 || (subscribe.hash && *subscribe.hash != layout_.hash())) {
    return;  // the viewer does not have the document with the layout yet
  }
  for (const std::string& name : subscribe.signals) {
    const SignalColumns* const columns = layout_.find(name);
    if (columns == nullptr) {
      viewer.queue_notice(NoticeLevel::error,
                          "subscribe: found " + in_quotes(name) + ", expected a signal of the document 'telemetry'");
      return;
    }
    subscription.columns.push_back(*columns);
  }
  if (!subscription.columns.empty()) {
    viewer.set_subscription(std::move(subscription), state_.history, subscribe.newest);
  }
}

void ViewerHub::report_lease(ServerTime now) {
  for (const ControlLease::Result& result : lease_.take_results()) {
    if (Viewer* const viewer = find(result.client)) {
      viewer->finish_operation(result.operation, result.error.empty(), json{{"epoch", lease_.epoch()}}, result.error);
    }
  }
  if (lease_.revision() == published_lease_) {
    return;
  }
  published_lease_ = lease_.revision();
  publish("control", lease_.document(now).dump());
  if (lease_.has_holder() != had_holder_ || lease_.is_away() != was_away_) {
    had_holder_ = lease_.has_holder();
    was_away_ = lease_.is_away();
    session_.holder_changed(had_holder_, was_away_);
  }
}

void ViewerHub::set_layout(SignalLayout layout, std::uint32_t tick_us, std::uint64_t generation) {
  layout_ = std::move(layout);
  generation_ = generation;
  publish("telemetry", layout_.document(tick_us).dump(-1, ' ', false, json::error_handler_t::replace));
  for (auto& [client, viewer] : viewers_) {
    viewer.set_subscription(std::nullopt, state_.history);
  }
}

void ViewerHub::answer(const OperationAnswer& answer) {
  const auto operation = operations_.find(answer.request);
  if (operation == operations_.end()) {
    return;  // the viewer has gone
  }
  if (Viewer* const viewer = find(operation->second.client)) {
    viewer->finish_operation(operation->second.id, answer.is_ok, answer.value, answer.error);
  }
  operations_.erase(operation);
}

void ViewerHub::stopped(const StopAnswer& answer) {
  if (const auto other = other_stops_.extract(answer.request)) {
    other.mapped()(answer);
    return;
  }
  const auto stop = stops_.find(answer.request);
  if (stop == stops_.end()) {
    return;
  }
  if (Viewer* const viewer = find(stop->second)) {
    viewer->queue_stopped(
        json{{"type", "stopped"}, {"confirmed", answer.confirmed}, {"of", answer.of}, {"ms", answer.ms}}.dump());
  }
  stops_.erase(stop);
}

std::optional<OutgoingMessage> ViewerHub::next_message(ServerTime now, ClientId client) {
  Viewer* const viewer = find(client);
  return viewer == nullptr ? std::nullopt : viewer->next_message(now, state_);
}

void ViewerHub::advance(ServerTime now) {
  lease_.advance(now);
  report_lease(now);
  state_.rate.update(now, state_.history.end());
  for (auto& [client, viewer] : viewers_) {
    viewer.advance(now);
  }
}

ServerTime ViewerHub::deadline(ServerTime now) const {
  ServerTime deadline = lease_.deadline();
  for (const auto& [client, viewer] : viewers_) {
    deadline = std::min(deadline, viewer.deadline(now, state_));
  }
  return deadline;
}

}  // namespace proleg::host
