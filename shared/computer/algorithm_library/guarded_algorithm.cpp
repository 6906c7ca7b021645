#include "shared/computer/algorithm_library/guarded_algorithm.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "shared/computer/algorithm_library/guarded_arrays.hpp"
#include "shared/computer/algorithm_library/guarded_call.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg {
namespace {

using Array = GuardedArrays::Array;

/// The joint of a call. Some functions do not receive the joint for which they compute. Their parameters are those of a
/// slot on a joint, so the last call with a joint and the same parameters identifies it.
struct KnownJoint {
  const std::int32_t* parameters = nullptr;
  unsigned joint = 0;
  std::optional<std::uint32_t> tick;
};

/// Memory of a thread for its calls.
struct ThreadMemory {
  GuardedArrays arrays;
  std::array<KnownJoint, 256> joints;

  KnownJoint& joint_with(const std::int32_t* parameters) {
    return joints[reinterpret_cast<std::uintptr_t>(parameters) / 64 % joints.size()];
  }
};

ThreadMemory& thread_memory() {
  thread_local const std::unique_ptr<ThreadMemory> memory = std::make_unique<ThreadMemory>();
  return *memory;
}

}  // namespace

/// One call of a function of the algorithm.
class GuardedAlgorithm::Call {
 public:
  Call(const GuardedAlgorithm& algorithm, const char* function, const std::int32_t* parameters)
      : algorithm_(algorithm), function_(function), parameters_(parameters), memory_(thread_memory()) {
    if (algorithm.has_failed_) {
      const std::lock_guard lock(algorithm.mutex_);
      throw AlgorithmFailure(algorithm.failure_);
    }
  }

  void at(unsigned joint, std::optional<std::uint32_t> tick) {
    memory_.joint_with(parameters_) = {parameters_, joint, tick};
  }

  const std::int32_t* give(Array array, const std::int32_t* values, std::size_t count) {
    given_[given_count_++] = {array, {values, count}, nullptr};
    return memory_.arrays.place(array, {values, count});
  }
  /// Copies values into a guarded array for the call. They are copied back when the call has ended without an error.
  std::int32_t* lend(Array array, std::int32_t* values, std::size_t count) {
    given_[given_count_++] = {array, {values, count}, values};
    return memory_.arrays.place(array, {values, count});
  }
  Tuning give(const Tuning& tuning) {
    return {give(Array::parameters, tuning.parameters, algorithm_.declaration().parameters.size()),
            give(Array::derived, tuning.derived, max_derived)};
  }

  template <typename Function>
  void run(Function&& function) {
    CallFailure failure;
    if (!run_guarded({algorithm_.subject_.c_str(), function_}, function, failure)) {
      const std::optional<std::string> missed =
          failure.address == nullptr ? std::nullopt : memory_.arrays.missed_by(failure.address);
      memory_.arrays.repair();
      algorithm_.fail(where(), missed.value_or(failure.text));
    }
    for (std::size_t i = 0; i < given_count_; ++i) {
      const Given& given = given_[i];
      if (const auto damage = memory_.arrays.damage(
              given.array, given.back == nullptr ? given.values : std::span<const std::int32_t>())) {
        memory_.arrays.repair();
        algorithm_.fail(where(), *damage);
      }
    }
    for (std::size_t i = 0; i < given_count_; ++i) {
      if (given_[i].back != nullptr) {
        std::ranges::copy(memory_.arrays.values(given_[i].array), given_[i].back);
      }
    }
  }

 private:
  struct Given {
    Array array{};
    std::span<const std::int32_t> values;
    std::int32_t* back = nullptr;
  };

  [[nodiscard]] std::string where() const {
    std::string text = std::string("in ") + function_ + "()";
    if (const KnownJoint& known = memory_.joint_with(parameters_); known.parameters == parameters_) {
      if (known.tick) {
        text += " at tick " + std::to_string(*known.tick);
      }
      text += ", joint " + std::to_string(known.joint) + " (0 is at the head)";
    }
    return text;
  }

  const GuardedAlgorithm& algorithm_;
  const char* function_;
  const std::int32_t* parameters_;
  ThreadMemory& memory_;
  std::array<Given, GuardedArrays::array_count> given_{};
  std::size_t given_count_ = 0;
};

GuardedAlgorithm::GuardedAlgorithm(std::string file, const ActuationModule& foreign,
                                   const CapturedDeclaration& captured, Senses senses)
    : file_(std::move(file)),
      foreign_(foreign),
      copy_(captured, file_),
      senses_(senses),
      subject_(one_line(file_ + ": the algorithm " + in_quotes(declaration().name))) {}

void GuardedAlgorithm::fail(const std::string& where, const std::string& what) const {
  const std::lock_guard lock(mutex_);
  if (!has_failed_) {
    failure_ = one_line(subject_ + " " + what + ", " + where);
    has_failed_ = true;
  }
  throw AlgorithmFailure(failure_);
}

void GuardedAlgorithm::derive(const JointContext& context, const std::int32_t* parameters,
                              std::int32_t* derived) const {
  Call call(*this, "derive", parameters);
  call.at(context.joint, std::nullopt);
  const std::int32_t* const given = call.give(Array::parameters, parameters, declaration().parameters.size());
  std::int32_t* const lent = call.lend(Array::derived, derived, max_derived);
  call.run([&] { foreign_.derive(context, given, lent); });
}

void GuardedAlgorithm::reset(const JointContext& context, const Tuning& tuning, Pcg32& noise,
                             std::int32_t* state) const {
  Call call(*this, "reset", tuning.parameters);
  call.at(context.joint, std::nullopt);
  const Tuning given = call.give(tuning);
  std::int32_t* const lent = call.lend(Array::state, state, declaration().internal_values.size());
  call.run([&] { foreign_.reset(context, given, noise, lent); });
}

void GuardedAlgorithm::rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const {
  Call call(*this, "rejoin", tuning.parameters);
  call.at(surroundings.context.joint, surroundings.tick);
  const Tuning given = call.give(tuning);
  std::int32_t* const lent = call.lend(Array::state, state, declaration().internal_values.size());
  call.run([&] { foreign_.rejoin(surroundings, given, lent); });
}

void GuardedAlgorithm::advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                               std::int32_t* next) const {
  Call call(*this, "advance", tuning.parameters);
  call.at(surroundings.context.joint, surroundings.tick);
  const Tuning given = call.give(tuning);
  const std::int32_t* const present = call.give(Array::state, state, declaration().internal_values.size());
  std::int32_t* const lent = call.lend(Array::next, next, declaration().internal_values.size());
  call.run([&] { foreign_.advance(surroundings, given, present, lent); });
}

std::int32_t GuardedAlgorithm::output(const Tuning& tuning, const std::int32_t* state) const {
  Call call(*this, "output", tuning.parameters);
  const Tuning given = call.give(tuning);
  const std::int32_t* const present = call.give(Array::state, state, declaration().internal_values.size());
  std::int32_t angle = 0;
  call.run([&] { angle = foreign_.output(given, present); });
  return angle;
}

void GuardedAlgorithm::extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& frame) const {
  Call call(*this, "extrapolate", tuning.parameters);
  const Tuning given = call.give(tuning);
  const std::int32_t* const present = call.give(Array::state, state, declaration().internal_values.size());
  std::array<std::int32_t, 2> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = static_cast<std::int32_t>(read_little_endian(frame.bytes, 4 * i, 4));
  }
  // The frame has the alignment of a word, and its bytes are those of two words on every computer that loads libraries.
  static_assert(sizeof(StateFrame) == sizeof words && std::endian::native == std::endian::little);
  auto* const lent = reinterpret_cast<StateFrame*>(call.lend(Array::frame, words.data(), words.size()));
  call.run([&] { foreign_.extrapolate(given, present, *lent); });
  for (std::size_t i = 0; i < words.size(); ++i) {
    write_little_endian(frame.bytes, 4 * i, 4, static_cast<std::uint32_t>(words[i]));
  }
}

}  // namespace proleg
