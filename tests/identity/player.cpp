#include "tests/identity/player.hpp"

#include <cstdio>
#include <utility>
#include <vector>

namespace proleg::identity {
namespace {

template <typename Robot>
class NativePlayer final : public Player {
 public:
  const Trace& play(const ActuationModule& algorithm, std::uint32_t number) override {
    const auto kernels = robot_.kernels();
    const Status status = run(kernels, algorithm, number, {}, trace_);
    expect_clean(status, trace_.missed_frames, number);
    return trace_;
  }

 private:
  Robot robot_;
  Trace trace_{};
};

class VariantPlayer final : public Player {
 public:
  VariantPlayer(std::filesystem::path program, Driver driver, std::uint32_t cases)
      : program_(std::move(program)), driver_(driver), cases_(cases) {
    if (!std::filesystem::exists(program_)) {
      throw PlayerError(program_.string() + " is missing; build the whole preset");
    }
  }

  const Trace& play(const ActuationModule& algorithm, std::uint32_t number) override {
    if (!pipe_) {
      const std::string command = "'" + program_.string() + "' " + std::to_string(algorithm.declaration().id) +
                                  (driver_ == Driver::whole ? " whole " : " modules ") + std::to_string(number) + " " +
                                  std::to_string(cases_);
      pipe_.reset(::popen(command.c_str(), "r"));
      if (!pipe_) {
        throw PlayerError("cannot start " + command);
      }
    }
    read(trace_.setpoints, number);
    read(trace_.servo_commands, number);
    return trace_;
  }

 private:
  struct CloseProcess {
    void operator()(std::FILE* pipe) const { ::pclose(pipe); }
  };

  void read(std::span<std::int32_t> values, std::uint32_t number) {
    std::vector<std::uint8_t> bytes(values.size() * 4);
    if (std::fread(bytes.data(), 1, bytes.size(), pipe_.get()) != bytes.size()) {
      throw PlayerError(program_.filename().string() + " gave up in case " + std::to_string(number));
    }
    decode(bytes, values);
  }

  std::filesystem::path program_;
  Driver driver_;
  std::uint32_t cases_;
  std::unique_ptr<std::FILE, CloseProcess> pipe_;
  Trace trace_{};
};

}  // namespace

void decode(std::span<const std::uint8_t> bytes, std::span<std::int32_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] =
        static_cast<std::int32_t>(bytes[4 * i] | std::uint32_t{bytes[4 * i + 1]} << 8U |
                                  std::uint32_t{bytes[4 * i + 2]} << 16U | std::uint32_t{bytes[4 * i + 3]} << 24U);
  }
}

void expect_clean(Status status, std::uint32_t missed_frames, std::uint32_t number) {
  if (status != Status::ok) {
    throw PlayerError("case " + std::to_string(number) + ": " + std::string(describe(status)));
  }
  if (missed_frames != 0) {
    throw PlayerError("case " + std::to_string(number) + ": " + std::to_string(missed_frames) +
                      " frames were missed though none was lost");
  }
}

std::unique_ptr<Player> make_native_player(Driver driver) {
  if (driver == Driver::whole) {
    return std::make_unique<NativePlayer<WholeRobot>>();
  }
  return std::make_unique<NativePlayer<Modules>>();
}

std::unique_ptr<Player> make_variant_player(const std::filesystem::path& program, Driver driver, std::uint32_t cases) {
  return std::make_unique<VariantPlayer>(program, driver, cases);
}

}  // namespace proleg::identity
