// A bare socket as the client.

#include "sim/mcu/debug/gdb_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "fake_target.hpp"

namespace proleg::sim {
namespace {

class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { leave(); }

  void send(std::string_view bytes) const {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  void packet(std::string_view payload) const { send(gdb_packet(payload)); }
  /// What has come so far.
  [[nodiscard]] std::string received() const {
    std::string text;
    std::array<char, 4096> bytes{};
    ssize_t length = 0;
    while ((length = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0) {
      text.append(bytes.data(), static_cast<std::size_t>(length));
    }
    return text;
  }
  /// Whether the next that comes is this; what the server has sent may still be on its way.
  [[nodiscard]] testing::AssertionResult gets(const std::string& expected) const {
    std::string text;
    for (int patience = 6'000; text.size() < expected.size() && patience > 0; --patience) {
      static_cast<void>(something_comes());
      text += received();
    }
    if (text == expected) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << "got " << text << ", expected " << expected;
  }
  [[nodiscard]] bool is_turned_away() const {
    for (int patience = 6'000; patience > 0 && !something_comes(); --patience) {
    }
    char byte = 0;
    const ssize_t count = recv(socket_, &byte, 1, MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }
  void say_no_more() const { shutdown(socket_, SHUT_WR); }
  void leave() {
    if (socket_ >= 0) {
      // Closed at once, so that thousands of clients leave no waiting ports behind.
      const linger at_once{1, 0};
      setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
      close(socket_);
      socket_ = -1;
    }
  }

 private:
  [[nodiscard]] bool something_comes() const {
    pollfd watched{socket_, POLLIN, 0};
    return poll(&watched, 1, 50) > 0;
  }

  int socket_;
};

class Server : public testing::Test {
 protected:
  static bool never() { return false; }

  Resume run(const Client& client) {
    client.packet("c");
    return server.serve(StopReason::attached, never);
  }
  // Serves until the client has received this, or until a timeout.
  testing::AssertionResult answers(const Client& client, const std::string& expected,
                                   StopReason reason = StopReason::attached) {
    std::string text;
    int patience = 6'000;
    const Resume resume = server.serve(reason, [&] {
      text += client.received();
      return text.size() >= expected.size() || --patience == 0;
    });
    if (text == expected && resume == Resume::interrupted) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << "got " << text << ", expected " << expected;
  }
  // What was sent may still be on its way.
  bool is_interrupted() {
    for (int patience = 300'000; patience > 0; --patience) {
      if (server.interrupt_requested()) {
        return true;
      }
      usleep(1000);
    }
    return false;
  }
  bool loses_its_client() {
    for (int patience = 300'000; patience > 0 && server.has_client(); --patience) {
      EXPECT_FALSE(server.interrupt_requested());
      usleep(1000);
    }
    return !server.has_client();
  }
  void let_in() { EXPECT_TRUE(server.wait_for_client(never)); }
  static std::string stop_reply(std::string_view signal) {
    return gdb_packet("T" + std::string(signal) + "07:00000000;0d:00000000;0e:00000000;0f:00000000;thread:1;");
  }

  FakeTarget target;
  GdbServer server{0, target};
};

TEST_F(Server, ReportsAPortInUseInOneLine) {
  try {
    const GdbServer second(server.port(), target);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              "127.0.0.1:" + std::to_string(server.port()) +
                  ": Address already in use; expected a TCP port that is free, for a debugger");
  }
}

TEST_F(Server, StopsWaitingForAClientWhenInterrupted) {
  EXPECT_FALSE(server.wait_for_client([] { return true; }));
  EXPECT_FALSE(server.has_client());
}

TEST_F(Server, AcknowledgesPacketsUntilNoAckMode) {
  const Client client(server.port());
  let_in();
  client.send("+$qC#b4");
  EXPECT_TRUE(answers(client, "+" + gdb_packet("QC1")));
  client.send("+$QStartNoAckMode#b0");
  EXPECT_TRUE(answers(client, "+" + gdb_packet("OK")));
  client.send("+$qC#b4");
  EXPECT_TRUE(answers(client, gdb_packet("QC1")));
}

TEST_F(Server, AsksForADamagedPacketAgainAndRepeatsItsOwn) {
  const Client client(server.port());
  let_in();
  client.send("$qC#b5");
  EXPECT_TRUE(answers(client, "-"));
  client.send("$qC#b4");
  EXPECT_TRUE(answers(client, "+" + gdb_packet("QC1")));
  client.send("-");
  EXPECT_TRUE(answers(client, gdb_packet("QC1")));
}

TEST_F(Server, AnswersAPacketThatIsTooLongWithAnError) {
  const Client client(server.port());
  let_in();
  client.packet(std::string(100'000, 'm'));
  EXPECT_TRUE(answers(client, "+" + gdb_packet("E16")));
}

TEST_F(Server, ReportsWhyTheTargetStoppedOnlyToAClientThatWaits) {
  const Client client(server.port());
  let_in();
  client.packet("qC");
  EXPECT_TRUE(answers(client, "+" + gdb_packet("QC1"), StopReason::attached));
  EXPECT_EQ(run(client), Resume::run);
  EXPECT_TRUE(answers(client, "+" + stop_reply("0b"), StopReason::fault));
}

TEST_F(Server, IsInterruptedByTheByteAndNotByAcknowledgements) {
  const Client client(server.port());
  let_in();
  EXPECT_EQ(run(client), Resume::run);
  EXPECT_FALSE(server.interrupt_requested());
  client.send("++");
  EXPECT_FALSE(server.interrupt_requested());
  client.send("\x03");
  EXPECT_TRUE(is_interrupted());
  EXPECT_FALSE(server.interrupt_requested());
}

TEST_F(Server, FindsAnInterruptThatCameTogetherWithTheCommandToRun) {
  const Client client(server.port());
  let_in();
  client.send(gdb_packet("c") + "\x03");
  EXPECT_EQ(server.serve(StopReason::attached, never), Resume::run);
  EXPECT_TRUE(is_interrupted());
}

TEST_F(Server, StopsTheTargetToAnswerAPacket) {
  const Client client(server.port());
  let_in();
  EXPECT_EQ(run(client), Resume::run);
  EXPECT_TRUE(client.gets("+"));
  client.packet("qC");
  EXPECT_TRUE(is_interrupted());
  EXPECT_TRUE(server.interrupt_requested());
  EXPECT_TRUE(answers(client, stop_reply("02") + "+" + gdb_packet("QC1"), StopReason::interrupt));
}

TEST_F(Server, LetsTheTargetRunFreelyWhenTheConnectionIsLost) {
  Client client(server.port());
  let_in();
  client.packet("Z0,8000100,2");
  EXPECT_EQ(run(client), Resume::run);
  EXPECT_EQ(target.breakpoints.size(), 1U);
  client.leave();
  EXPECT_TRUE(loses_its_client());
  EXPECT_TRUE(target.breakpoints.empty());
  EXPECT_EQ(server.serve(StopReason::fault, never), Resume::detach);
}

TEST_F(Server, LeavesServingWhenTheConnectionIsLost) {
  Client client(server.port());
  let_in();
  client.leave();
  EXPECT_EQ(server.serve(StopReason::attached, never), Resume::detach);
}

TEST_F(Server, StopsForAClientThatComesLater) {
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(server.interrupt_requested());
    const Client client(server.port());
    EXPECT_TRUE(is_interrupted());
    client.packet("?");
    EXPECT_TRUE(answers(client, "+" + stop_reply("05")));
    client.packet("D");
    EXPECT_EQ(server.serve(StopReason::attached, never), Resume::detach);
    EXPECT_TRUE(client.gets("+" + gdb_packet("OK")));
  }
}

TEST_F(Server, StopsForAClientThatComesWhenTheOtherIsLost) {
  Client first(server.port());
  let_in();
  EXPECT_EQ(run(first), Resume::run);
  first.leave();
  EXPECT_TRUE(loses_its_client());
  const Client second(server.port());
  EXPECT_TRUE(is_interrupted());
  second.packet("qC");
  EXPECT_TRUE(answers(second, "+" + gdb_packet("QC1"), StopReason::interrupt))
      << "it has not asked for the target to run";
}

TEST_F(Server, DisconnectsASecondClient) {
  const Client first(server.port());
  let_in();
  EXPECT_EQ(run(first), Resume::run);
  const Client second(server.port());
  usleep(1000);
  EXPECT_FALSE(server.interrupt_requested());
  EXPECT_TRUE(second.is_turned_away());
  const Client third(server.port());
  EXPECT_TRUE(answers(first, "+" + stop_reply("05"), StopReason::breakpoint));
  first.packet("qC");
  EXPECT_TRUE(answers(first, "+" + gdb_packet("QC1")));
  EXPECT_TRUE(third.is_turned_away());
}

TEST_F(Server, SendsTextsAndTheEndToAClientThatWaits) {
  const Client client(server.port());
  let_in();
  server.send_text("not now");
  EXPECT_EQ(run(client), Resume::run);
  server.send_text("hi\n");
  server.finish(3);
  EXPECT_TRUE(client.gets("+" + gdb_packet("O68690a") + gdb_packet("W03")));
  EXPECT_FALSE(server.has_client());
}

TEST_F(Server, DoesNotHangOnAClientThatDoesNotRead) {
  const Client client(server.port());
  let_in();
  // Answers of 16 kB, more than the sockets hold.
  std::string many;
  for (int i = 0; i < 2000; ++i) {
    many += gdb_packet("m20000000,2000");
  }
  client.send(many);
  int read = 0;
  int patience = 5;
  EXPECT_EQ(server.serve(StopReason::attached,
                         [&] {
                           patience = std::exchange(read, target.reads) == target.reads ? patience - 1 : 5;
                           return patience == 0;
                         }),
            Resume::interrupted);
  EXPECT_LT(read, 2000) << "answers pile up";
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(server.interrupt_requested());
    server.send_text("text");
  }
}

std::string random_stream(std::mt19937_64& random) {
  static constexpr std::array<std::string_view, 30> commands{"?",
                                                             "g",
                                                             "m20000000,10",
                                                             "m8000000,ffffffff",
                                                             "M20000000,2:0102",
                                                             "X20000000,1:a",
                                                             "Z0,8000100,2",
                                                             "z1,8000100,2",
                                                             "c",
                                                             "s",
                                                             "vCont;c",
                                                             "vCont;s:1;c",
                                                             "vCont?",
                                                             "p0",
                                                             "P0=00000000",
                                                             "D",
                                                             "k",
                                                             "Hg0",
                                                             "qC",
                                                             "qfThreadInfo",
                                                             "T1",
                                                             "qSupported:multiprocess+",
                                                             "QStartNoAckMode",
                                                             "qXfer:features:read:target.xml:0,ffb",
                                                             "qRcmd,74",
                                                             "qAttached",
                                                             "m2000fff0,20",
                                                             "C05;8000000",
                                                             "G",
                                                             "H"};
  static constexpr std::string_view structure = "$#+-\x03,;:=*}0123456789abcdef";
  std::string stream;
  for (std::uint64_t parts = random() % 12; parts > 0; --parts) {
    switch (random() % 5) {
      case 0:  // anything
        for (std::uint64_t i = random() % 20; i > 0; --i) {
          stream += static_cast<char>(random());
        }
        break;
      case 1:  // the protocol's own characters
        for (std::uint64_t i = random() % 20; i > 0; --i) {
          stream += structure[random() % structure.size()];
        }
        break;
      case 2:  // a good packet
        stream += gdb_packet(commands[random() % commands.size()]);
        break;
      case 3: {  // a packet with a right sum and wrong content
        std::string payload(commands[random() % commands.size()]);
        payload[random() % payload.size()] = static_cast<char>(random());
        payload.resize(random() % (payload.size() + 4), structure[random() % structure.size()]);
        stream += gdb_packet(payload);
        break;
      }
      default: {  // a damaged packet
        std::string packet = gdb_packet(commands[random() % commands.size()]);
        packet[random() % packet.size()] = static_cast<char>(random());
        stream += packet;
      }
    }
  }
  return stream;
}

TEST_F(Server, SurvivesTenThousandRandomStreams) {
  const unsigned seed = 13;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  server.set_monitor([](std::string_view text) { return std::string(text); });
  for (int round = 0; round < 10'000; ++round) {
    const std::string stream = random_stream(random);
    SCOPED_TRACE("stream " + std::to_string(round));
    Client client(server.port());
    let_in();
    client.send(stream);
    client.say_no_more();
    int stops = 0;
    while (server.has_client() && ++stops < 1000) {
      const Resume resume = server.serve(StopReason::step, never);
      for (int slice = 0; resume == Resume::run && slice < 10 && !server.interrupt_requested(); ++slice) {
        target.run_slice();
      }
    }
    ASSERT_LT(stops, 1000);
    ASSERT_TRUE(target.breakpoints.empty());
    client.leave();
  }
  const Client client(server.port());
  let_in();
  client.packet("qC");
  EXPECT_TRUE(answers(client, "+" + gdb_packet("QC1")));
}

}  // namespace
}  // namespace proleg::sim
