#include "tests/identity/sensing_probe.hpp"

#include "shared/fixed/arithmetic.hpp"

namespace proleg::identity {
namespace {

enum Parameters : std::uint8_t { amplitude };
constexpr Parameter parameters[] = {
    Parameter{"amplitude", Unit::degree, raw(Unit::degree, 40), 0, quarter_turn, "largest joint angle"},
};

enum Values : std::uint8_t { mixture };
constexpr InternalValue internal_values[] = {
    InternalValue{"mixture", Unit::phase_degree, 0, "scrambled history of the contacts"},
};

constexpr Declaration about{127,        "SensingProbe",  "set-points from contacts, for tests",
                            parameters, internal_values, {}};

class SensingProbe final : public SensingModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    return multiply(tuning.parameters[amplitude], state[mixture], 31);
  }

 private:
  void advance_sensing(const Contacts& contacts, const Surroundings& /*surroundings*/, const Tuning& /*tuning*/,
                       const std::int32_t* state, std::int32_t* next) const override {
    std::uint32_t pressed = 0;
    for (unsigned link = 0; link < contacts.link_count(); ++link) {
      pressed = pressed << 1U | (contacts.pressed(link, TouchSensor::rear) ? 1U : 0U);
      pressed = pressed << 1U | (contacts.pressed(link, TouchSensor::front) ? 1U : 0U);
    }
    // A linear congruential step is invertible: two histories that differ never meet again under equal contacts.
    next[mixture] = static_cast<std::int32_t>(static_cast<std::uint32_t>(state[mixture]) * 1664525U + 1013904223U +
                                              (pressed << 8U));
  }
};

constexpr SensingProbe instance;

constexpr InternalValue reading_values[] = {
    InternalValue{"mixture", Unit::phase_degree, 0, "scrambled history of the readings"},
};
constexpr Declaration about_readings{126,        "ReadingProbe", "set-points from readings, for tests",
                                     parameters, reading_values, {}};

class ReadingProbe final : public ActuationModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about_readings; }

  [[nodiscard]] std::uint8_t senses_readings() const override { return JointReadings::all_sensors; }

  void advance(const Surroundings& surroundings, const Tuning& /*tuning*/, const std::int32_t* state,
               std::int32_t* next) const override {
    const JointReadings& readings = surroundings.readings;
    const std::int32_t values[] = {std::int32_t{readings.present},
                                   readings.current_ma,
                                   readings.pitch,
                                   readings.roll,
                                   readings.acceleration_mm_s2[0],
                                   readings.acceleration_mm_s2[1],
                                   readings.acceleration_mm_s2[2],
                                   readings.angle};
    auto mixed = static_cast<std::uint32_t>(state[mixture]);
    for (const std::int32_t value : values) {
      mixed = mixed * 1664525U + 1013904223U + static_cast<std::uint32_t>(value);
    }
    next[mixture] = static_cast<std::int32_t>(mixed);
  }

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    return multiply(tuning.parameters[amplitude], state[mixture], 31);
  }
};

constexpr ReadingProbe reading_instance;

}  // namespace

const SensingModule& sensing_probe() { return instance; }

const ActuationModule& reading_probe() { return reading_instance; }

}  // namespace proleg::identity
