#include "sim/scenario/losses.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <tuple>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "shared/kernel/kernel.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::sim {
namespace {

constexpr const char* seed_form = "SEED:RATE or SEED:RATE@FIRST-LAST, for example 7:5% or 7:0.05@100-900";

[[noreturn]] void refuse(const std::string& argument) {
  throw InputError("--losses", 0, in_quotes(argument), seed_form);
}

std::uint32_t require_rate(const std::string& text, const std::string& argument) {
  const std::optional<std::uint32_t> rate = parse_rate(text);
  if (!rate) {
    throw InputError("--losses", 0, "rate " + in_quotes(text) + " in " + in_quotes(argument), "0 to 1, or 0% to 100%");
  }
  return *rate;
}

Losses parse_random(const std::string& argument, std::size_t colon) {
  RandomLosses random;
  const auto seed = parse_whole<std::uint64_t>(argument.substr(0, colon));
  if (!seed) {
    refuse(argument);
  }
  random.seed = *seed;
  const std::size_t at = argument.find('@', colon);
  random.threshold = require_rate(argument.substr(colon + 1, at == std::string::npos ? at : at - colon - 1), argument);
  if (at != std::string::npos) {
    const std::size_t dash = argument.find('-', at);
    if (dash == std::string::npos) {
      refuse(argument);
    }
    const auto first = parse_whole<std::uint32_t>(argument.substr(at + 1, dash - at - 1));
    const auto last = parse_whole<std::uint32_t>(argument.substr(dash + 1));
    if (!first || !last || *first > *last) {
      refuse(argument);
    }
    random.first_tick = *first;
    random.last_tick = *last;
  }
  return Losses(random);
}

std::uint8_t parse_joint(const std::string& name, const RobotModel& robot, const std::string& path, int line) {
  const int joint = find_joint(robot, name);
  if (joint < 0) {
    throw InputError(path, line, "unknown joint " + in_quotes(name), "one of " + listed(joint_names(robot)));
  }
  return static_cast<std::uint8_t>(joint);
}

std::vector<Loss> read_list(const std::string& path, const RobotModel& robot) {
  constexpr std::uintmax_t max_bytes = 16U << 20U;
  std::string expected = "a list of losses, or ";
  expected += seed_form;
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(in_quotes(path), 0, *found, expected);
  }
  std::error_code error;
  if (std::filesystem::file_size(path, error) > max_bytes) {
    throw InputError(path, 0, "a file above 16 MiB", expected);
  }
  std::ifstream file(path);
  if (!file) {
    throw InputError(path, 0, "a file that cannot be read", expected);
  }
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) {
    throw InputError(path, 0, "a file that cannot be read to its end", "a list of losses");
  }
  std::vector<Loss> list;
  TextLines lines(bytes);
  while (const std::optional<std::string_view> text = lines.next()) {
    const int line = lines.number();
    std::vector<std::string> fields;
    for (const std::string_view field : words(text->substr(0, text->find('#')))) {
      fields.emplace_back(field);
    }
    if (fields.empty()) {
      continue;
    }
    const auto tick = parse_whole<std::uint32_t>(fields[0]);
    const bool has_channel = fields.size() == 4;
    if (!tick || fields.size() < 3 || fields.size() > 4 || (has_channel && fields[3] != "1" && fields[3] != "2")) {
      throw InputError(path, line, in_quotes(*text), "TICK SENDER RECEIVER [CHANNEL], channel 1 or 2");
    }
    Loss loss{*tick, parse_joint(fields[1], robot, path, line),
              static_cast<std::uint8_t>(has_channel && fields[3] == "2" ? 1 : 0), 0, line};
    if (fields[2] != "*") {
      loss.receiver = parse_joint(fields[2], robot, path, line);
      if (loss.receiver == loss.sender) {
        throw InputError(path, line, fields[1] + " as sender and receiver",
                         "two different joints: a joint does not receive its own frames");
      }
      list.push_back(loss);
      continue;
    }
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
      loss.receiver = static_cast<std::uint8_t>(joint);
      if (loss.receiver != loss.sender) {
        list.push_back(loss);
      }
    }
  }
  return list;
}

auto order(const Loss& loss) { return std::tuple(loss.tick, loss.sender, loss.channel, loss.receiver); }

}  // namespace

Losses::Losses(std::vector<Loss> list, std::string source) : list_(std::move(list)), source_(std::move(source)) {
  std::ranges::sort(list_, {}, order);
}

JointMask Losses::receivers_without(std::uint32_t tick, unsigned sender, unsigned channel) const {
  JointMask receivers;
  const Loss first{tick, static_cast<std::uint8_t>(sender), static_cast<std::uint8_t>(channel), 0};
  for (auto loss = std::ranges::lower_bound(list_, order(first), {}, order);
       loss != list_.end() && loss->tick == tick && loss->sender == sender && loss->channel == channel; ++loss) {
    receivers.insert(loss->receiver);
  }
  if (random_.threshold != 0 && tick >= random_.first_tick && tick <= random_.last_tick) {
    Pcg32 noise(random_.seed, (std::uint64_t{tick} * max_joints + sender) * max_channels + channel);
    for (unsigned receiver = 0; receiver < max_joints; ++receiver) {
      if (noise.next() < random_.threshold && receiver != sender) {
        receivers.insert(receiver);
      }
    }
  }
  return receivers;
}

void Losses::require_effect(std::uint32_t ticks, const KernelConfiguration& kernel) const {
  const std::string expected = "ticks of the run, 0 to " + std::to_string(ticks - 1);
  if (random_.threshold != 0 && random_.first_tick >= ticks) {
    throw InputError("--losses", 0, "losses from tick " + std::to_string(random_.first_tick) + " on", expected);
  }
  for (const Loss& loss : list_) {
    if (loss.tick >= ticks) {
      throw InputError(source_, loss.line, "a loss at tick " + std::to_string(loss.tick), expected);
    }
    if (loss.channel == 1 && !kernel.second_channel_senders().contains(loss.sender)) {
      throw InputError(source_, loss.line, "a loss on channel 2 at tick " + std::to_string(loss.tick),
                       "a sender with two broadcasting algorithms");
    }
  }
}

Losses read_losses(const std::string& argument, const RobotModel& robot) {
  const std::size_t colon = argument.find(':');
  const bool starts_with_seed =
      colon != std::string::npos && colon > 0 &&
      std::ranges::all_of(argument.substr(0, colon), [](char c) { return c >= '0' && c <= '9'; });
  if (starts_with_seed) {
    return parse_random(argument, colon);
  }
  return Losses(read_list(argument, robot), argument);
}

}  // namespace proleg::sim
