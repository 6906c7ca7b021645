#include "tests/identity/qemu_player.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/mcu/cpu/elf_image.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::identity {
namespace {

/// A chip of QEMU, which stands still until its debugger lets it run.
class Qemu {
 public:
  Qemu(const std::filesystem::path& program, const std::filesystem::path& image, const std::filesystem::path& socket) {
    const std::string debugger = "unix:" + socket.string() + ",server=on,wait=off";
    process_ = fork();
    if (process_ == 0) {
      execl(program.c_str(), program.c_str(), "-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial",
            "none", "-S", "-gdb", debugger.c_str(), "-kernel", image.c_str(), nullptr);
      _exit(127);
    }
  }
  Qemu(const Qemu&) = delete;
  Qemu& operator=(const Qemu&) = delete;
  ~Qemu() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }

  [[nodiscard]] bool has_ended() {
    if (process_ > 0 && waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
    }
    return process_ <= 0;
  }

 private:
  pid_t process_ = -1;
};

/// The debugger's side of gdb's remote protocol (gdb's manual, appendix E): a command, and its reply.
class Debugger {
 public:
  Debugger(Qemu& qemu, const std::filesystem::path& path) : socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = path.string();
    if (name.size() >= sizeof address.sun_path) {
      throw PlayerError(name + ": the name is too long for a socket");
    }
    std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
    while (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      if (qemu.has_ended()) {
        throw PlayerError("QEMU has ended before it took a connection");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  Debugger(const Debugger&) = delete;
  Debugger& operator=(const Debugger&) = delete;
  ~Debugger() { close(socket_); }

  std::string command(const std::string& text) {
    unsigned sum = 0;
    for (const char character : text) {
      sum += static_cast<unsigned char>(character);
    }
    std::string packet = "$" + text + "#" + hexadecimal_byte(static_cast<std::uint8_t>(sum & 0xFFU));
    if (write(socket_, packet.data(), packet.size()) != static_cast<ssize_t>(packet.size())) {
      throw PlayerError("QEMU takes no command");
    }
    while (receive() != '$') {  // before it: the acknowledgement of the command
    }
    std::string reply;
    for (char character = receive(); character != '#'; character = receive()) {
      // A run: the character before it, and its length above 28.
      if (character == '*' && !reply.empty()) {
        constexpr int least = 29;
        reply.append(static_cast<std::size_t>(receive() - least), reply.back());
      } else {
        reply.push_back(character);
      }
    }
    static_cast<void>(receive());
    static_cast<void>(receive());
    constexpr char acknowledged = '+';
    static_cast<void>(write(socket_, &acknowledged, 1));
    return reply;
  }

  void expect_ok(const std::string& text) {
    if (const std::string reply = command(text); reply != "OK") {
      throw PlayerError("QEMU answers '" + reply + "' to '" + text + "'");
    }
  }

  static std::string hexadecimal_byte(std::uint8_t byte) {
    constexpr std::string_view digits = "0123456789abcdef";
    return {digits[byte >> 4U], digits[byte & 0xFU]};
  }

 private:
  char receive() {
    if (next_ == received_) {
      constexpr int max_silence_ms = 300'000;
      pollfd waiting{socket_, POLLIN, 0};
      const ssize_t count = poll(&waiting, 1, max_silence_ms) > 0 ? read(socket_, buffer_.data(), buffer_.size()) : -1;
      if (count <= 0) {
        throw PlayerError("QEMU is silent, or has ended");
      }
      next_ = 0;
      received_ = static_cast<std::size_t>(count);
    }
    return buffer_.at(next_++);
  }

  int socket_;
  std::array<char, 4096> buffer_{};
  std::size_t next_ = 0;
  std::size_t received_ = 0;
};

/// Bytes of hexadecimal text. PlayerError if it is an error message of the emulator, or has another length.
std::vector<std::uint8_t> bytes_of(const std::string& text, std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  if (text.size() != 2 * size) {
    throw PlayerError("QEMU answers '" + text.substr(0, 20) + "', expected " + std::to_string(size) + " bytes");
  }
  for (std::size_t i = 0; i < size; ++i) {
    const char* const begin = text.data() + 2 * i;
    if (std::from_chars(begin, begin + 2, bytes[i], 16).ptr != begin + 2) {
      throw PlayerError("QEMU answers '" + text.substr(0, 20) + "', expected hexadecimal digits");
    }
  }
  return bytes;
}

std::string hexadecimal_number(std::uint32_t value) {
  std::array<char, 8> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, 16).ptr};
}

class QemuPlayer final : public Player {
 public:
  QemuPlayer(const std::filesystem::path& program, const std::filesystem::path& file)
      : image_(file),
        wait_(address_of("wait_for_calls")),
        run_(address_of("identity_run")),
        trace_address_(image_.symbol("identity_trace").address),
        qemu_(program, file, folder_ / "gdb"),
        debugger_(qemu_, folder_ / "gdb") {
    // QEMU reads and writes single registers only for a debugger that knows their description.
    static_cast<void>(debugger_.command("qXfer:features:read:target.xml:0,ffb"));
    debugger_.expect_ok("Z1," + hexadecimal_number(wait_) + ",2");
    debugger_.expect_ok("Z1," + hexadecimal_number(address_of("fault_handler")) + ",2");
    run_start_up();
  }

  const Trace& play(const ActuationModule& algorithm, std::uint32_t number) override {
    constexpr unsigned lr = 14;
    write_register(0, algorithm.declaration().id);
    write_register(1, number);
    write_register(lr, wait_ | 1U);
    write_register(pc, run_);
    run_to_wait(number);
    const auto status = static_cast<Status>(read_register(0));
    // The trace as the image lays it out: the count of missed frames, set-points, servo commands.
    std::array<std::int32_t, 1> missed_frames{};
    read(trace_address_, missed_frames);
    trace_.missed_frames = static_cast<std::uint32_t>(missed_frames[0]);
    expect_clean(status, trace_.missed_frames, number);
    read(trace_address_ + 4, trace_.setpoints);
    read(trace_address_ + 4 + static_cast<std::uint32_t>(sizeof trace_.setpoints), trace_.servo_commands);
    return trace_;
  }

 private:
  static constexpr unsigned pc = 15;

  /// Address of the first instruction of a function.
  [[nodiscard]] std::uint32_t address_of(const char* function) const { return image_.symbol(function).address & ~1U; }

  /// Runs the start-up to where it sleeps for ever. An instruction before, because a sleeping CPU would not run again.
  void run_start_up() {
    constexpr std::size_t code_size = 256;
    constexpr std::array<std::uint8_t, 2> wait_for_interrupt{0x30, 0xBF};
    const std::uint32_t start = address_of("reset_handler");
    const std::vector<std::uint8_t> code =
        bytes_of(debugger_.command("m" + hexadecimal_number(start) + "," + hexadecimal_number(code_size)), code_size);
    const auto found = std::search(code.begin(), code.end(), wait_for_interrupt.begin(), wait_for_interrupt.end());
    if (found == code.end()) {
      throw PlayerError("the start-up of the image does not end in wfi");
    }
    const std::uint32_t end = start + static_cast<std::uint32_t>(found - code.begin());
    debugger_.expect_ok("Z1," + hexadecimal_number(end) + ",2");
    if (const std::string reason = debugger_.command("c"); read_register(pc) != end) {
      throw PlayerError("QEMU stopped with '" + reason + "' in the start-up");
    }
  }

  void run_to_wait(std::uint32_t number) {
    const std::string reason = debugger_.command("c");
    if (reason.substr(0, 3) != "T05" || read_register(pc) != wait_) {
      throw PlayerError("QEMU stopped with '" + reason + "' in case " + std::to_string(number) + ", at " +
                        hexadecimal_number(read_register(pc)));
    }
  }

  void write_register(unsigned number, std::uint32_t value) {
    std::string text;
    for (unsigned i = 0; i < 4; ++i) {
      text += Debugger::hexadecimal_byte(static_cast<std::uint8_t>(value >> 8U * i & 0xFFU));
    }
    debugger_.expect_ok("P" + hexadecimal_number(number) + "=" + text);
  }

  [[nodiscard]] std::uint32_t read_register(unsigned number) {
    const std::vector<std::uint8_t> bytes = bytes_of(debugger_.command("p" + hexadecimal_number(number)), 4);
    std::array<std::int32_t, 1> value{};
    decode(bytes, value);
    return static_cast<std::uint32_t>(value[0]);
  }

  void read(std::uint32_t address, std::span<std::int32_t> values) {
    constexpr std::size_t values_in_packet = 256;
    for (std::size_t first = 0; first < values.size(); first += values_in_packet) {
      const std::size_t count = std::min(values_in_packet, values.size() - first);
      const std::string command = "m" + hexadecimal_number(address + 4 * static_cast<std::uint32_t>(first)) + "," +
                                  hexadecimal_number(4 * static_cast<std::uint32_t>(count));
      decode(bytes_of(debugger_.command(command), 4 * count), values.subspan(first, count));
    }
  }

  sim::ElfImage image_;
  std::uint32_t wait_;
  std::uint32_t run_;
  std::uint32_t trace_address_;
  TemporaryFolder folder_;
  Qemu qemu_;
  Debugger debugger_;
  Trace trace_{};
};

}  // namespace

std::unique_ptr<Player> make_qemu_player(const std::filesystem::path& program, const std::filesystem::path& image) {
  return std::make_unique<QemuPlayer>(program, image);
}

}  // namespace proleg::identity
