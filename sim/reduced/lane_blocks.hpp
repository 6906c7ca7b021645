#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <vector>

namespace proleg::sim::reduced {

/// The memory of the chains of a batch: blocks of as many chains as a vector has lanes, and one more block in which the
/// chains with weak motors are stepped. Number i of a chain is the double at i * width + its lane of its block. All
/// blocks have one scratch memory, for what a step computes and nothing keeps: so it stays in the processor's cache.
class LaneBlocks {
 public:
  /// width: a power of two. numbers: how many a chain has; they are 0 at first. scratch_numbers: how many a step of a
  /// chain needs; they are NaN at first, so a step that reads what it has not computed gives wrong results at once.
  LaneBlocks(std::size_t chains, std::size_t width, std::size_t numbers, std::size_t scratch_numbers)
      : size_(chains),
        width_(width),
        log2_width_(static_cast<unsigned>(std::countr_zero(width))),
        block_size_(numbers * width),
        numbers_(allocate(block_size_ * (blocks() + 1), 0.0)),
        scratch_(allocate(scratch_numbers * width, std::numeric_limits<double>::quiet_NaN())) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t blocks() const { return (size_ + width_ - 1) / width_; }
  /// The lanes of the last block that have no chain are filled up with copies of a chain.
  [[nodiscard]] std::size_t lanes() const { return blocks() * width_; }
  [[nodiscard]] double* block(std::size_t number) const { return numbers_.get() + number * block_size_; }
  [[nodiscard]] double* scratch() const { return scratch_.get(); }
  /// Number i of an array of a lane. array: the array in block(0). lane: from 0, over all blocks.
  [[nodiscard]] double& of(std::size_t lane, const double* array, std::size_t i) const {
    const auto offset = static_cast<std::size_t>(array - numbers_.get());
    return numbers_[(lane >> log2_width_) * block_size_ + offset + (i << log2_width_) + (lane & (width_ - 1))];
  }

  /// Copies the first numbers of an array from a lane to another one.
  void copy(std::size_t from, std::size_t to, const double* array, std::size_t count) const {
    if (count == 0) {
      return;
    }
    const double* source = &of(from, array, 0);
    double* target = &of(to, array, 0);
    *target = *source;
    for (std::size_t left = count - 1; left > 0; --left) {
      source += width_;
      target += width_;
      *target = *source;
    }
  }
  /// How many numbers of a lane lie from one array to another one that follows.
  [[nodiscard]] std::size_t numbers_between(const double* array, const double* next) const {
    return static_cast<std::size_t>(next - array) >> log2_width_;
  }

  /// strong(block): steps the chains of a block; the bits of those that have weak motors. weak(block): steps these.
  /// copy(from, to): copies the numbers of a lane to another one; copy_back(from, to): those that a step changes.
  template <typename Strong, typename Weak, typename Copy, typename CopyBack>
  void step(Strong&& strong, Weak&& weak, Copy&& copy, CopyBack&& copy_back) {
    weak_.clear();
    for (std::size_t number = 0; number < blocks(); ++number) {
      const unsigned bits = strong(block(number));
      for (std::size_t lane = 0; lane < width_ && (bits >> lane) != 0; ++lane) {
        if ((bits >> lane & 1U) != 0 && number * width_ + lane < size_) {
          weak_.push_back(number * width_ + lane);
        }
      }
    }
    for (std::size_t first = 0; first < weak_.size(); first += width_) {
      const std::span chains = std::span(weak_).subspan(first, std::min(width_, weak_.size() - first));
      // The lanes that are left do what the first one does.
      for (std::size_t lane = 0; lane < width_; ++lane) {
        copy(chains[lane < chains.size() ? lane : 0], lanes() + lane);
      }
      weak(block(blocks()));
      for (std::size_t lane = 0; lane < chains.size(); ++lane) {
        copy_back(lanes() + lane, chains[lane]);
      }
    }
  }

 private:
  static constexpr std::size_t alignment = 64;  // bytes, of the widest vector
  struct Free {
    void operator()(double* numbers) const { ::operator delete[](numbers, std::align_val_t{alignment}); }
  };
  using Numbers = std::unique_ptr<double[], Free>;

  static Numbers allocate(std::size_t count, double value) {
    Numbers numbers(static_cast<double*>(::operator new[](count * sizeof(double), std::align_val_t{alignment})));
    std::fill_n(numbers.get(), count, value);
    return numbers;
  }

  std::size_t size_;
  std::size_t width_;
  unsigned log2_width_;
  std::size_t block_size_;  ///< numbers of a block
  Numbers numbers_;
  Numbers scratch_;
  std::vector<std::size_t> weak_;  ///< chains that have weak motors in this step
};

}  // namespace proleg::sim::reduced
