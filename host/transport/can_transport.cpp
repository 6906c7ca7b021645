#include "host/transport/open_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <deque>
#include <utility>

#include "host/transport/can_socket.hpp"
#include "host/transport/event_loop.hpp"
#include "host/transport/frame_queue.hpp"

namespace proleg::host {
namespace {

constexpr Microseconds retry_pause = 1'000;  // a full queue (ENOBUFS) cannot be waited for
/// Duration without a frame on the bus after which the waiting frames are out of date.
constexpr Microseconds send_timeout = 500'000;
constexpr Microseconds first_pause = 100'000;
constexpr Microseconds longest_pause = 2'000'000;
constexpr unsigned reads_in_a_row = 64;  // frames that are read before other work of the context runs

class CanTransport final : public Transport {
 public:
  CanTransport(boost::asio::io_context& context, std::string interface, TransportListener& listener)
      : context_(context),
        interface_(std::move(interface)),
        listener_(listener),
        retry_(context, [this] { write_queue(); }),
        reconnect_(context, [this] { reconnect(); }) {
    try {
      connect();
    } catch (const TransportError& error) {
      throw TransportError(interface_ + ": " + error.what(), error.problem());
    }
  }
  ~CanTransport() override { disconnect(); }

  [[nodiscard]] Microseconds now() const override { return steady_now(); }
  [[nodiscard]] bool send(const CanFrame& frame) override {
    const bool is_first = queue_.empty() && unconfirmed_.empty();
    if (!socket_) {
      ++statistics_.dropped_out;
      return false;
    }
    if (!queue_.push(frame, statistics_.dropped_out)) {
      return false;
    }
    if (is_first) {
      last_progress_ = now();
    }
    // The frame is not sent in this call, because the listener may be called when the interface has failed. With
    // frames before it the timer is already set: for frames of the same call, or for another attempt to send one that
    // the kernel has refused.
    if (queue_.size() == 1) {
      retry_.set(now());
    }
    return true;
  }
  void run_until(Microseconds deadline) override {
    was_called_ = false;
    host::run_until(context_, deadline, was_called_);
  }
  [[nodiscard]] const BusState& state() const override { return state_; }
  [[nodiscard]] Statistics statistics() const override { return statistics_; }
  [[nodiscard]] std::string description() const override { return interface_ + ", CAN interface of Linux"; }

 private:
  void connect() {
    socket_ = std::make_unique<CanSocket>(interface_, CanSocket::Options{});
    watch_ = std::make_unique<DescriptorWatch>(context_, socket_->descriptor(), [this] { read_frames(); });
    ++statistics_.connections;
    dropped_before_ = statistics_.dropped_in;
    pause_ = first_pause;
    state_.is_connected = true;
    state_.reason.clear();
    state_.controller = {};
  }
  void disconnect() {
    watch_.reset();
    socket_.reset();
    retry_.set(never);
  }
  void reconnect() {
    try {
      connect();
      notify();
    } catch (const TransportError& error) {
      lose(error.what());
    }
  }
  void lose(const std::string& reason) {
    disconnect();
    drop_frames();
    const bool is_new = state_.is_connected || state_.reason != reason;
    state_.is_connected = false;
    state_.reason = reason;
    reconnect_.set(now() + pause_);
    pause_ = std::min(2 * pause_, longest_pause);
    if (is_new) {
      notify();
    }
  }
  void drop_frames() {
    statistics_.dropped_out += queue_.size();
    statistics_.unconfirmed += unconfirmed_.size();
    queue_.clear();
    unconfirmed_.clear();
  }

  void read_frames() {
    for (unsigned i = 0; i < reads_in_a_row && socket_; ++i) {
      const auto received = socket_->read();
      if (!received) {
        if (socket_->error() != 0) {
          lose(can_failure(interface_, socket_->error()));
        }
        return;
      }
      count_drops(dropped_before_ + socket_->dropped());
      handle(*received);
    }
  }
  void count_drops(std::uint64_t dropped) {
    if (dropped != statistics_.dropped_in) {
      // Confirmations can be among the frames that were dropped.
      statistics_.unconfirmed += unconfirmed_.size();
      unconfirmed_.clear();
    }
    statistics_.dropped_in = dropped;
  }
  void handle(const CanSocket::Received& received) {
    if ((received.frame.can_id & CAN_ERR_FLAG) != 0) {
      handle_error(received.frame);
      return;
    }
    const auto frame = protocol_frame(received.frame);
    if (!frame) {
      ++statistics_.foreign;
    } else if (received.is_own) {
      confirm(received.time, *frame);
    } else {
      ++statistics_.received;
      was_called_ = true;
      listener_.received(received.time, *frame);
    }
  }
  void confirm(Microseconds time, const CanFrame& frame) {
    const auto place = std::find(unconfirmed_.begin(), unconfirmed_.end(), frame);
    if (place != unconfirmed_.end()) {
      unconfirmed_.erase(place);
    }
    ++statistics_.transmitted;
    last_progress_ = now();
    was_called_ = true;
    if (!state_.reason.empty()) {
      state_.reason.clear();
      listener_.state_changed(state_);
    }
    listener_.transmitted(time, frame);
  }
  void handle_error(const can_frame& frame) {
    const CanErrorReport report = read_can_error(frame, state_.controller);
    state_.controller = report.status;
    state_.errors.add(report.errors);
    ++state_.bus_errors;
    notify();
  }

  void write_queue() {
    while (socket_ && !queue_.empty()) {
      const int error = socket_->write(queue_.front());
      if (error == ENOBUFS || error == EAGAIN) {
        wait_for_room();
        return;
      }
      if (error != 0 && error != EINTR) {
        lose(can_failure(interface_, error));
        return;
      }
      if (error == 0) {
        unconfirmed_.push_back(queue_.front());
        queue_.pop();
      }
    }
    if (!unconfirmed_.empty()) {
      wait_for_room();
    }
  }
  /// Waits while frames wait here or in the kernel. If none has reached the bus for some time, they are given up.
  void wait_for_room() {
    if (now() < last_progress_ + send_timeout) {
      retry_.set(queue_.empty() ? last_progress_ + send_timeout : now() + retry_pause);
      return;
    }
    const bool was_full = !queue_.empty();
    drop_frames();
    state_.reason = blocked_text(was_full);
    notify();
  }
  /// One line that says why no frame reaches the bus.
  [[nodiscard]] std::string blocked_text(bool is_queue_full) const {
    if (state_.controller.state == CanState::bus_off) {
      return "the controller is bus-off after too many errors: check the bit rate and the wires, then sudo ip link "
             "set " +
             interface_ + " down; sudo ip link set " + interface_ + " up";
    }
    if (state_.errors.contains(CanErrorKind::acknowledgement) || state_.controller.transmit_errors > 0) {
      return "no node acknowledges a frame: has the robot power, is the bit rate 1 Mbit/s, are both terminators there?";
    }
    return is_queue_full ? "the queue of the interface stays full: sudo ip link set " + interface_ +
                               " txqueuelen 1000, or no node acknowledges frames"
                         : "the interface confirms no frame: does no node acknowledge them?";
  }

  void notify() {
    was_called_ = true;
    listener_.state_changed(state_);
  }

  boost::asio::io_context& context_;
  const std::string interface_;
  TransportListener& listener_;
  std::unique_ptr<CanSocket> socket_;
  std::unique_ptr<DescriptorWatch> watch_;
  Timer retry_;
  Timer reconnect_;
  BusState state_;
  Statistics statistics_;
  FrameQueue queue_;                  ///< frames that the kernel has not taken
  std::deque<CanFrame> unconfirmed_;  ///< frames that the kernel has taken and not confirmed
  Microseconds last_progress_ = 0;  ///< time at which a frame was confirmed, or the first frame was given to the kernel
  Microseconds pause_ = first_pause;
  std::uint64_t dropped_before_ = 0;
  bool was_called_ = false;  ///< the listener was called
};

}  // namespace

std::unique_ptr<Transport> open_can_transport(boost::asio::io_context& context, const std::string& interface,
                                              TransportListener& listener) {
  return std::make_unique<CanTransport>(context, interface, listener);
}

}  // namespace proleg::host
