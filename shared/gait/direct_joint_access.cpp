#include "shared/gait/algorithms.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { angle };
constexpr Parameter parameters[] = {
    Parameter{"angle", Unit::degree, 0, -quarter_turn, quarter_turn, "The angle at which the joint stands."},
};

constexpr Declaration about{1, "DirectJointAccess", "joint angles set by hand", parameters, {}, {}};

class DirectJointAccess final : public ActuationModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void advance(const Surroundings& /*surroundings*/, const Tuning& /*tuning*/, const std::int32_t* /*state*/,
               std::int32_t* /*next*/) const override {}

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* /*state*/) const override {
    return tuning.parameters[angle];
  }
};

constexpr DirectJointAccess instance;

}  // namespace

const ActuationModule& direct_joint_access() { return instance; }

}  // namespace proleg
