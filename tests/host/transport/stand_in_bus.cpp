// Stands in for proleg-bus in tests of `sim:`: stand_in_bus FILE --fd 3. FILE: "serve" carries frames until the client
// goes; "offer" does so for clients of a pseudo terminal and a TCP port, whose names it prints, and gives each frame to
// the others; "fail" ends with status 2 at once; "die" ends by a signal when the first frame comes; "stay" ignores
// SIGTERM and the end of the client.

#include <unistd.h>
#include <csignal>

#include <cstdio>
#include <string>

#include "test_bus.hpp"

namespace {

using namespace proleg;
using namespace proleg::host;

class Bus final : public BusServerListener {
 public:
  Bus(boost::asio::io_context& context, std::string behaviour)
      : context_(context), behaviour_(std::move(behaviour)), server(context, *this) {}

  [[nodiscard]] bool frame_from_client(BusClient client, const CanFrame& frame) override {
    if (behaviour_ == "die") {
      raise(SIGKILL);
    }
    // With --fd there is one client, which sees its own frames again.
    server.broadcast(steady_now(), frame, behaviour_ == "offer" ? client : no_client);
    return true;
  }
  void descriptor_closed() override {
    if (behaviour_ != "stay") {
      context_.stop();
    }
  }

 private:
  boost::asio::io_context& context_;
  const std::string behaviour_;

 public:
  BusServer server;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 || std::string(argv[2]) != "--fd" || std::string(argv[1]) == "fail") {
    return 2;
  }
  if (std::string(argv[1]) == "stay") {
    signal(SIGTERM, SIG_IGN);
  }
  alarm(1200);  // in case the test has been killed
  boost::asio::io_context context;
  Bus bus(context, argv[1]);
  if (std::string(argv[1]) == "offer") {
    const std::string name = bus.server.add_pseudo_terminal();
    std::printf("%s %u\n", name.c_str(), unsigned{bus.server.add_tcp("127.0.0.1", 0)});
    std::fflush(stdout);
  } else {
    bus.server.add_descriptor(std::stoi(argv[3]));
  }
  host::run_until(context, never, false);
  return 0;
}
