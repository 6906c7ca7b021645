#pragma once

#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/transport/bus_server.hpp"
#include "host/transport/byte_stream.hpp"
#include "host/transport/event_loop.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host::test {

/// A test that waits longer has failed.
inline constexpr Microseconds longest_wait = 300'000'000;

/// Keeps what a transport reports.
class Log final : public TransportListener {
 public:
  void received(Microseconds /*time*/, const CanFrame& frame) override { frames.push_back(frame); }
  void transmitted(Microseconds /*time*/, const CanFrame& frame) override { sent.push_back(frame); }
  void state_changed(const BusState& state) override { states.push_back(state); }

  std::vector<CanFrame> frames;
  std::vector<CanFrame> sent;
  std::vector<BusState> states;
};

/// A bus on which each frame of a client is at once.
class LoopBus final : public BusServerListener {
 public:
  [[nodiscard]] bool frame_from_client(BusClient client, const CanFrame& frame) override {
    frames.push_back(frame);
    server->broadcast(steady_now(), frame, client);
    return true;
  }
  void client_event(const std::string& line) override { events.push_back(line); }
  void descriptor_closed() override { has_closed = true; }

  BusServer* server = nullptr;
  std::vector<CanFrame> frames;
  std::vector<std::string> events;
  bool has_closed = false;
};

/// An adapter at the other end of a descriptor, which answers each line by a script.
class ScriptedAdapter final : public ByteStreamOwner {
 public:
  using Script = std::function<std::string(const std::string& line)>;

  ScriptedAdapter(boost::asio::io_context& context, Descriptor descriptor, Script script)
      : script_(std::move(script)), stream_(context, std::move(descriptor), false, *this) {}

  void write(std::string_view text) {
    output_ += text;
    stream_.flush();
  }

  std::vector<std::string> lines;
  bool has_ended = false;
  std::function<void()> on_end;

 private:
  void read(std::string_view bytes) override {
    input_ += bytes;
    for (std::size_t end = input_.find('\r'); end != std::string::npos; end = input_.find('\r')) {
      lines.push_back(input_.substr(0, end));
      input_.erase(0, end + 1);
      write(script_(lines.back()));
    }
  }
  [[nodiscard]] std::string take_output(std::size_t max_bytes) override {
    const std::string taken = output_.substr(0, max_bytes);
    output_.erase(0, taken.size());
    return taken;
  }
  void ended(int /*error*/) override {
    has_ended = true;
    if (on_end) {
      on_end();
    }
  }

  Script script_;
  std::string input_;
  std::string output_;
  ByteStream stream_;
};

/// The two ends of a stream; the reads and writes of both return at once.
inline std::array<Descriptor, 2> socket_pair() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error("no socket pair");
  }
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// Runs the context until something holds. False: that took too long.
inline bool wait_for(boost::asio::io_context& context, const std::function<bool()>& holds) {
  const Microseconds deadline = steady_now() + longest_wait;
  const bool is_done = false;
  while (!holds() && steady_now() < deadline) {
    run_until(context, steady_now() + 1'000, is_done);
  }
  return holds();
}

inline CanFrame numbered_frame(unsigned number) {
  return {static_cast<std::uint16_t>(0x601 + number % 5),
          8,
          {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8U), 1, 2, 3, 4, 5, 6}};
}
inline std::vector<CanFrame> numbered_frames(unsigned count) {
  std::vector<CanFrame> frames;
  for (unsigned number = 0; number < count; ++number) {
    frames.push_back(numbered_frame(number));
  }
  return frames;
}

/// Sends frames as fast as the transport takes them.
inline bool send_all(Transport& transport, const std::vector<CanFrame>& frames) {
  const Microseconds deadline = steady_now() + longest_wait;
  for (const CanFrame& frame : frames) {
    while (!transport.send(frame)) {
      if (steady_now() > deadline || !transport.state().is_connected) {
        return false;
      }
      transport.run_until(steady_now() + 1'000);
    }
  }
  return true;
}

}  // namespace proleg::host::test
