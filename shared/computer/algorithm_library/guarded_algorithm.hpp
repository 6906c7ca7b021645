#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>

#include "shared/computer/algorithm_library/declaration_copy.hpp"
#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// The failure of a user's algorithm. what() is one line with the error, and library, algorithm, function, tick and
/// joint as far as they are known.
class AlgorithmFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The inputs that an algorithm reads from its module and its robot.
struct Senses {
  bool contacts = false;
  std::uint8_t readings = 0;
};

/// A user's algorithm, called so that its errors are reported: it may throw, crash, loop, and write outside its arrays.
/// Each function then throws AlgorithmFailure, also through the core, which has no code to clean up. After a failure
/// all later calls fail with the same text, without a call.
///
/// Threads may use it at the same time.
class GuardedAlgorithm final : public ActuationModule {
 public:
  /// file: name of the library, for messages. foreign: must outlive this object. captured: its declaration. Throws
  /// InputError if that is wrong.
  GuardedAlgorithm(std::string file, const ActuationModule& foreign, const CapturedDeclaration& captured,
                   Senses senses);
  ~GuardedAlgorithm() = default;

  [[nodiscard]] const Declaration& declaration() const override { return copy_.declaration(); }
  [[nodiscard]] bool senses_contacts() const override { return senses_.contacts; }
  [[nodiscard]] std::uint8_t senses_readings() const override { return senses_.readings; }
  void derive(const JointContext& context, const std::int32_t* parameters, std::int32_t* derived) const override;
  void reset(const JointContext& context, const Tuning& tuning, Pcg32& noise, std::int32_t* state) const override;
  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override;
  void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
               std::int32_t* next) const override;
  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override;
  void extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& frame) const override;

  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  class Call;

  [[noreturn]] void fail(const std::string& where, const std::string& what) const;

  std::string file_;
  const ActuationModule& foreign_;
  DeclarationCopy copy_;
  Senses senses_;
  std::string subject_;  ///< subject of the messages
  mutable std::atomic<bool> has_failed_ = false;
  mutable std::mutex mutex_;
  mutable std::string failure_;
};

}  // namespace proleg
