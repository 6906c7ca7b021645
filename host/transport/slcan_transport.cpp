#include "host/transport/open_transport.hpp"

#include <algorithm>
#include <boost/system/system_error.hpp>
#include <optional>

#include "host/transport/byte_stream.hpp"
#include "host/transport/event_loop.hpp"

namespace proleg::host {
namespace {

constexpr Microseconds first_pause = 100'000;
constexpr Microseconds longest_pause = 5'000'000;
/// The program that serves the bus may have been started in the same moment: `proleg bus FILE --tcp PORT &`.
constexpr Microseconds start_of_a_program = 2'000'000;

class SlcanTransport final : public Transport, private ByteStreamOwner, private SlcanClientListener {
 public:
  SlcanTransport(boost::asio::io_context& context, std::string address, std::unique_ptr<Link> link,
                 TransportListener& listener)
      : context_(context),
        address_(std::move(address)),
        link_(std::move(link)),
        listener_(listener),
        client_(*this, link_->client_settings()),
        timer_(context, [this] { handle_time(); }) {}

  ~SlcanTransport() override {
    if (stream_ && client_.state() != SlcanClient::State::idle) {
      client_.stop();
      stream_->write_last(client_.take(now(), 100));
    }
  }

  /// Opens the bus. Returns when the channel is open. Throws TransportError.
  void open() {
    const Microseconds patience_ends = now() + start_of_a_program;
    for (std::size_t attempt = 0; phase_ != Phase::open; ++attempt) {
      connect();
      while (phase_ == Phase::connecting || phase_ == Phase::starting) {
        host::run_until(context_, never, has_changed_phase_);
        if (!has_changed_phase_) {
          throw TransportError(address_ + ": the program ends");
        }
        has_changed_phase_ = false;
      }
      if (phase_ == Phase::open || attempt + 1 < link_->alternatives()) {
        continue;
      }
      if (problem_ == TransportProblem::no_listener && now() < patience_ends) {
        const bool ends_early = false;
        host::run_until(context_, now() + first_pause, ends_early);
        has_changed_phase_ = false;
      } else {
        throw TransportError(address_ + ": " + state_.reason, problem_);
      }
    }
    is_opened_ = true;
  }

  [[nodiscard]] Microseconds now() const override { return steady_now(); }
  [[nodiscard]] bool send(const CanFrame& frame) override {
    const bool is_taken = client_.send(frame);
    if (is_taken && stream_) {
      stream_->flush();
    }
    return is_taken;
  }
  void run_until(Microseconds deadline) override {
    was_called_ = false;
    host::run_until(context_, deadline, was_called_);
  }
  [[nodiscard]] const BusState& state() const override { return state_; }
  [[nodiscard]] Statistics statistics() const override {
    Statistics statistics = client_.statistics();
    statistics.received = received_;
    statistics.connections = connections_;
    return statistics;
  }
  [[nodiscard]] std::string description() const override {
    const std::string& adapter = client_.adapter();
    return address_ + ", slcan adapter" + (adapter.empty() ? "" : " " + adapter) +
           (client_.is_acknowledging() ? "" : " without acknowledgements");
  }

 private:
  enum class Phase : std::uint8_t {
    idle,        ///< before the first connection
    connecting,  ///< connect() is under way
    starting,    ///< the commands of the start are under way
    open,
    pause,  ///< before the next connection
    ended,
  };

  void set_phase(Phase phase) {
    phase_ = phase;
    has_changed_phase_ = true;
  }

  void connect() {
    try {
      Link::Opened opened = link_->open();
      stream_ = std::make_unique<ByteStream>(context_, std::move(opened.descriptor), opened.is_connecting,
                                             static_cast<ByteStreamOwner&>(*this));
      if (opened.is_connecting) {
        set_phase(Phase::connecting);
        timer_.set(now() + link_->connect_timeout());
      } else {
        connected();
      }
    } catch (const TransportError& error) {
      lose(error.what(), error.problem());
    } catch (const boost::system::system_error& error) {  // a descriptor that cannot be waited for, such as a file
      lose("it is no line or socket: " + std::string(system_text(error.code().value())));
    }
  }

  void connected() override {
    set_phase(Phase::starting);
    state_.controller = {};  // the adapter reports another state when its channel is opened
    client_.start(now());
    proceed();
  }

  void read(std::string_view bytes) override {
    client_.input(now(), bytes);
    proceed();
  }
  [[nodiscard]] std::string take_output(std::size_t max_bytes) override {
    std::string output = client_.take(now(), max_bytes);
    timer_.set(client_.next_deadline());
    return output;
  }
  void ended(int error) override {
    if (phase_ == Phase::connecting) {
      lose(link_->connect_failure(error), link_->connect_problem(error));
    } else {
      lose(link_->end_text(error));
    }
  }

  void handle_time() {
    if (phase_ == Phase::pause) {
      connect();
    } else if (phase_ == Phase::connecting) {
      lose(link_->connect_failure(ETIMEDOUT));
    } else if (phase_ == Phase::starting || phase_ == Phase::open) {
      client_.poll(now());
      proceed();
    }
  }

  /// Handles the state of the client after each of its events.
  void proceed() {
    if (client_.state() == SlcanClient::State::failed) {
      lose(client_.error() + "; " + link_->silence_hint(), client_.problem());
      return;
    }
    if (client_.state() == SlcanClient::State::open && phase_ == Phase::starting) {
      set_phase(Phase::open);
      ++connections_;
      pause_ = first_pause;
      state_.is_connected = true;
      state_.reason.clear();
      notify();
    }
    if (!stream_) {
      return;
    }
    if (client_.has_output()) {
      stream_->flush();
    }
    timer_.set(client_.next_deadline());
  }

  void lose(const std::string& reason, TransportProblem problem = TransportProblem::other) {
    problem_ = problem;
    stream_.reset();
    client_.stop();
    const bool is_new = state_.is_connected || state_.reason != reason;
    state_.is_connected = false;
    state_.reason = reason;
    if (is_opened_ && link_->can_reopen()) {
      set_phase(Phase::pause);
      timer_.set(now() + pause_);
      pause_ = std::min(2 * pause_, longest_pause);
    } else {
      set_phase(Phase::ended);
      timer_.set(never);
    }
    if (is_new && is_opened_) {
      notify();
    }
  }

  void notify() {
    was_called_ = true;
    listener_.state_changed(state_);
  }
  void received(Microseconds time, const CanFrame& frame) override {
    ++received_;
    was_called_ = true;
    listener_.received(time, frame);
  }
  void transmitted(Microseconds time, const CanFrame& frame) override {
    was_called_ = true;
    listener_.transmitted(time, frame);
  }
  void status_received(const CanStatus& status) override {
    state_.controller = status;
    notify();
  }
  void errors_received(CanErrors errors) override {
    ++state_.bus_errors;
    state_.errors.add(errors);
    notify();
  }

  boost::asio::io_context& context_;
  const std::string address_;
  const std::unique_ptr<Link> link_;
  TransportListener& listener_;
  SlcanClient client_;
  std::unique_ptr<ByteStream> stream_;
  Timer timer_;
  Phase phase_ = Phase::idle;
  BusState state_;
  TransportProblem problem_ = TransportProblem::other;  ///< why the connection was lost
  std::uint64_t received_ = 0;
  std::uint64_t connections_ = 0;
  Microseconds pause_ = first_pause;
  bool has_changed_phase_ = false;
  bool is_opened_ = false;   ///< open() has returned
  bool was_called_ = false;  ///< the listener was called
};

}  // namespace

std::unique_ptr<Transport> open_slcan_transport(boost::asio::io_context& context, const std::string& address,
                                                std::unique_ptr<Link> link, TransportListener& listener) {
  auto transport = std::make_unique<SlcanTransport>(context, address, std::move(link), listener);
  transport->open();
  return transport;
}

}  // namespace proleg::host
