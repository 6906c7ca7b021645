#include "tests/identity/cortex_m_player.hpp"

#include <span>
#include <vector>

#include "tests/cortex_m/core_image.hpp"

namespace proleg::identity {
namespace {

class CortexMPlayer final : public Player {
 public:
  CortexMPlayer(cortex_m::Cpu cpu, const std::filesystem::path& image)
      : image_(image), machine_(image_, cpu), trace_address_(image_.symbol("identity_trace").address) {}

  const Trace& play(const ActuationModule& algorithm, std::uint32_t number) override {
    // Some thirty times what the dearest case needs on Cortex-M0.
    constexpr std::uint64_t budget = 1'000'000'000;
    const auto status =
        static_cast<Status>(machine_.call("identity_run", {algorithm.declaration().id, number}, budget).value);
    // The trace as the image lays it out: the count of missed frames, set-points, servo commands.
    trace_.missed_frames = machine_.read_word(trace_address_);
    expect_clean(status, trace_.missed_frames, number);
    read(trace_address_ + 4, trace_.setpoints);
    read(trace_address_ + 4 + static_cast<std::uint32_t>(sizeof trace_.setpoints), trace_.servo_commands);
    return trace_;
  }

 private:
  void read(std::uint32_t address, std::span<std::int32_t> values) {
    std::vector<std::uint8_t> bytes(values.size() * 4);
    machine_.read(address, bytes);
    decode(bytes, values);
  }

  cortex_m::ElfImage image_;
  cortex_m::Machine machine_;
  std::uint32_t trace_address_;
  Trace trace_{};
};

}  // namespace

std::unique_ptr<Player> make_cortex_m_player(cortex_m::Cpu cpu) {
  return make_cortex_m_player(cpu, cortex_m::core_image_file(cpu));
}

std::unique_ptr<Player> make_cortex_m_player(cortex_m::Cpu cpu, const std::filesystem::path& image) {
  return std::make_unique<CortexMPlayer>(cpu, image);
}

}  // namespace proleg::identity
