#pragma once

// A robot of modules: a kernel for each joint. They exchange nothing but state frames.

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "robot.hpp"

namespace proleg::test {

class ModuleChain {
 public:
  explicit ModuleChain(const KernelConfiguration& configuration) {
    for (unsigned joint = 0; joint < configuration.joint_count; ++joint) {
      modules_.push_back(std::make_unique<KernelOf<1>>());
      EXPECT_EQ(modules_.back()->configure(configuration, joint), Status::ok);
      order_.push_back(joint);
    }
  }

  [[nodiscard]] Kernel& operator[](unsigned joint) { return *modules_[joint]; }
  [[nodiscard]] unsigned size() const { return static_cast<unsigned>(modules_.size()); }

  /// Passes every frame labelled with the coming tick to every other module, except those that `loses` selects.
  template <typename Loses>
  void exchange(Loses loses) {
    for (const unsigned receiver : order_) {
      for (const unsigned sender : order_) {
        if (sender != receiver && !loses(sender, receiver)) {
          for (unsigned channel = 0; channel < modules_[sender]->channel_count(sender); ++channel) {
            EXPECT_TRUE(modules_[receiver]->receive(sender, channel, modules_[sender]->frame(sender, channel)));
          }
        }
      }
    }
  }

  void exchange() {
    exchange([](unsigned, unsigned) { return false; });
  }

  void advance() {
    for (const unsigned joint : order_) {
      modules_[joint]->advance();
    }
  }

  void tick() {
    exchange();
    advance();
  }

  /// Visits modules and frames in another order from now on.
  void shuffle(std::mt19937& random) { std::shuffle(order_.begin(), order_.end(), random); }

  void reset() {
    for (auto& module : modules_) {
      module->reset();
    }
  }

 private:
  std::vector<std::unique_ptr<KernelOf<1>>> modules_;
  std::vector<unsigned> order_;
};

}  // namespace proleg::test
