#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/kernel.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// The contacts that a search finds, each with its impulse of the step before. A lane has only its
/// own contacts, one after the other, so that a step costs what the busiest lane needs and not what all need together.
template <typename Kind, int width>
class ContactList {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = typename Quantities<Kind, Number>::Vector;

  /// The number of contacts in the lane that has most.
  [[nodiscard]] std::size_t most() const { return most_; }
  /// The lanes that have contact k.
  [[nodiscard]] Mask has(std::size_t k) const { return counts_ > static_cast<double>(k); }

 protected:
  ContactList(const ChainForm<Kind>& form, const ChainMemory<Kind, Number>& memory,
              const ChainScratch<Kind, Number>& scratch)
      : form_(form), m_(memory), s_(scratch), stride_(form.counts.joints + Kind::spin_axes) {}

  void start() {
    for (std::size_t link = 0; link < form_.counts.links; ++link) {
      m_.pressed[link] = Number{};
    }
    for (int lane = 0; lane < width; ++lane) {
      found_[lane] = 0;
      old_[lane] = 0;
    }
  }

  [[nodiscard]] bool is_full(int lane) const { return found_[lane] == form_.counts.contacts; }

  /// Contacts come by ascending pair in each step. first_key: the first of the Kind::contact_keys that the pair has.
  /// Returns the number of the contact.
  std::size_t add(int lane, std::size_t link, double first_key, double key, const Vector& arm, const Number& depth,
                  const Number& friction) {
    const std::size_t contact = found_[lane]++;
    s_.link[contact][lane] = static_cast<double>(link);
    s_.key[contact][lane] = key;
    put_lane(s_.arm, contact, lane, arm);
    s_.depth_speed[contact][lane] = depth[lane];
    s_.friction[contact][lane] = friction[lane];
    take_old_impulse(lane, contact, first_key, key);
    return contact;
  }

  void press(std::size_t link, int lane, int sensor) const {
    m_.pressed[link][lane] = static_cast<double>(static_cast<int>(m_.pressed[link][lane]) | sensor);
  }

  /// Counts the contacts, and clears those that only other lanes have: what another chain has left in the scratch
  /// memory may be no number, and then 0 times it is none either. clear(k, lanes): clears what the kind has of its own.
  template <typename Clear>
  void count(const Clear& clear) {
    most_ = found_[0];
    std::size_t fewest = found_[0];
    for (int lane = 0; lane < width; ++lane) {
      most_ = found_[lane] > most_ ? found_[lane] : most_;
      fewest = found_[lane] < fewest ? found_[lane] : fewest;
      counts_[lane] = static_cast<double>(found_[lane]);
    }
    turn_depths_to_speeds();
    for (std::size_t k = fewest; k < most_; ++k) {
      const Mask lanes = ~has(k);
      put_where(lanes, s_.link[k], Number{});
      put_where(lanes, s_.depth_speed[k], Number{});
      put_where(lanes, s_.friction[k], Number{});
      put_where(lanes, s_.arm, k, Vector{});
      put_where(lanes, s_.old_impulse, k, Vector{});
      clear(k, lanes);
    }
  }

  /// How a contact slides.
  struct Slide {
    Mask on_terrain;
    Number speed;  ///< m/s
    Number power;  ///< W, of friction
  };
  /// Keeps the contacts of the lanes that are done. slide_of(k, impulse, steps_per_s): a Slide.
  template <typename SlideOf>
  void keep_contacts(Mask done, const SlideOf& slide_of) const {
    const double steps_per_s = 1.0 / form_.step_s;
    put_where(done, m_.contact_count[0], counts_);
    Space<Number> sliding{};
    for (std::size_t k = 0; k < most_; ++k) {
      const Vector impulse = at<Vector>(s_.value, k);
      put_where(done, m_.contact_key[k], s_.key[k]);
      put_where(done, m_.impulse, k, impulse);
      const Slide slide = slide_of(k, impulse, steps_per_s);
      const Number force = impulse.z * steps_per_s;
      // A lane that an earlier round has solved may have numbers here that are not finite.
      sliding = sliding + select(done & slide.on_terrain & has(k),
                                 Space<Number>{force, force * slide.speed, slide.power}, Space<Number>{});
    }
    put_where(done, m_.sliding, 0, sliding);
  }

  const ChainForm<Kind>& form_;
  const ChainMemory<Kind, Number>& m_;
  const ChainScratch<Kind, Number>& s_;
  std::size_t stride_;  ///< from row to row, in unknowns
  Number counts_{};     ///< how many contacts each lane has

 private:
  void take_old_impulse(int lane, std::size_t contact, double first_key, double key) {
    const auto count = static_cast<std::size_t>(m_.contact_count[0][lane]);
    std::size_t& old = old_[lane];
    while (old < count && m_.contact_key[old][lane] < first_key) {
      ++old;
    }
    std::size_t candidate = old;
    while (candidate < count && m_.contact_key[candidate][lane] < first_key + Kind::contact_keys &&
           m_.contact_key[candidate][lane] != key) {
      ++candidate;
    }
    const bool is_old = candidate < count && m_.contact_key[candidate][lane] == key;
    for (std::size_t axis = 0; axis < Kind::axes; ++axis) {
      s_.old_impulse[Kind::axes * contact + axis][lane] =
          is_old ? m_.impulse[Kind::axes * candidate + axis][lane] : 0.0;
    }
  }

  void turn_depths_to_speeds() const {
    constexpr double error_reduction = 0.2;  // share of a depth that a step corrects, as in sim/ode
    // m, of a contact at rest. If it were 0, such contacts would end, the link fall and touch anew, again and again.
    constexpr double rest_depth = 1e-6;
    const double factor = error_reduction / form_.step_s;
    for (std::size_t k = 0; k < most_; ++k) {
      s_.depth_speed[k] = (s_.depth_speed[k] - rest_depth) * factor;
    }
  }

  std::size_t most_ = 0;
  std::size_t found_[static_cast<unsigned>(width)];
  std::size_t old_[static_cast<unsigned>(width)];  ///< number of the first contact of the last step that may come again
};

/// Finds the contacts of a kind of chains, and says how an impulse of theirs moves the chain.
template <typename Kind, int width>
class Contacts;

}  // namespace
}  // namespace proleg::sim::reduced
