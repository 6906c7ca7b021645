// reduced_golden STEPS [SIZE]...: steps the golden chains, those in a plane and those in space, with each kernel that
// the processor has, in batches of these sizes or of several, and prints a line for each: kernel, size of the batches,
// and the fields of golden.tsv.
//
// reduced_golden --write-golden FILE: writes golden.tsv. For a change of the engine that is meant to change results;
// the change of the file then belongs to the same commit.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/reduced/chain_batch.hpp"
#include "tests/sim/reduced/golden/golden_chains.hpp"

namespace {

using namespace proleg::sim::reduced;
using namespace proleg::sim::reduced::golden;

constexpr std::size_t batch_sizes[] = {1, 2, 3, 7, 16, 64};
constexpr std::size_t golden_steps[] = {500, 20000};
constexpr std::size_t sample_steps = 100;
constexpr std::size_t command_steps = 10;

/// FNV-1a, 64 bits.
class Hash {
 public:
  void add(std::uint64_t bits) {
    for (unsigned shift = 0; shift < 64; shift += 8) {
      value_ = (value_ ^ (bits >> shift & 0xFFU)) * 0x100000001B3U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

/// What chains did, at the steps that are sampled.
struct Outcome {
  unsigned long on_terrain = 0;   ///< times that a chain touched the terrain
  unsigned long on_itself = 0;    ///< times that a chain touched itself
  unsigned long weak_motors = 0;  ///< times that a motor gave all that it can, and more than nothing
  unsigned long failures = 0;     ///< chains that broke down, or did not what the same chain did elsewhere in the batch
  Hash state;                     ///< of the chains' hashes of all their states and poses
};

void add_state(const ChainBatch<Planar>& batch, std::size_t place, Hash& hash) {
  for (const double value : batch.state(place)) {
    hash.add(std::bit_cast<std::uint64_t>(value));
  }
  for (std::size_t link = 0; link < link_count; ++link) {
    const ChainBatch<Planar>::LinkPlace at = batch.link_place(place, link);
    for (const double value : {at.position.x, at.position.z, at.half_sine, at.half_cosine}) {
      hash.add(std::bit_cast<std::uint64_t>(value));
    }
  }
}

void add_state(const ChainBatch<Spatial>& batch, std::size_t place, Hash& hash) {
  for (const double value : batch.state(place)) {
    hash.add(std::bit_cast<std::uint64_t>(value));
  }
  for (std::size_t link = 0; link < link_count; ++link) {
    const ChainBatch<Spatial>::LinkPlace at = batch.link_place(place, link);
    for (const Point3& point : {at.position, at.axes[0], at.axes[1], at.axes[2]}) {
      for (const double value : {point.x, point.y, point.z}) {
        hash.add(std::bit_cast<std::uint64_t>(value));
      }
    }
  }
}

bool touches_itself(const ChainBatch<Planar>& batch, std::size_t place) {
  double force = 0.0;
  for (std::size_t link = 0; link < link_count; ++link) {
    force += batch.contact_force(place, link);
  }
  return force > batch.sliding(place).normal_force * 1.001;
}

bool touches_itself(const ChainBatch<Spatial>& batch, std::size_t place) {
  return batch.touching_links(place).has_value();
}

template <typename Batch>
void count(const Batch& batch, std::size_t place, std::size_t chain, Outcome& outcome) {
  outcome.on_terrain += batch.sliding(place).normal_force > 0.0 ? 1U : 0U;
  outcome.on_itself += touches_itself(batch, place) ? 1U : 0U;
  for (std::size_t joint = 0; joint < joint_count; ++joint) {
    const double most = max_torque(chain, joint);
    const double torque = batch.motor_torque(place, joint);
    outcome.weak_motors += most > 0.0 && (torque == most || torque == -most) ? 1U : 0U;
  }
}

/// chains: which are in the batch, and their hashes, by place.
template <typename Batch>
void run_batch(Batch& batch, std::span<const std::size_t> chains, std::span<Hash> hashes, std::size_t steps,
               Outcome& outcome) {
  const auto for_each_motor = [&](const auto& action) {
    for (std::size_t place = 0; place < chains.size(); ++place) {
      for (std::size_t joint = 0; joint < joint_count; ++joint) {
        action(place, joint, chains[place]);
      }
    }
  };
  for_each_motor([&](std::size_t place, std::size_t joint, std::size_t chain) {
    batch.set_max_torque(place, joint, max_torque(chain, joint));
  });
  for (std::size_t step = 0; step < steps; ++step) {
    if (step % command_steps == 0) {
      for_each_motor([&](std::size_t place, std::size_t joint, std::size_t chain) {
        batch.set_wanted_speed(place, joint, wanted_speed(chain, joint, step));
      });
    }
    batch.step();
    if ((step + 1) % sample_steps == 0) {
      for (std::size_t place = 0; place < chains.size(); ++place) {
        add_state(batch, place, hashes[place]);
        if (place < chain_count) {
          count(batch, place, chains[place], outcome);
        }
      }
    }
  }
}

/// A batch that has more places than there are chains has some of them twice or more often.
template <typename Batch, typename Model>
Outcome run(const std::vector<Model>& models, const ChainKernel& kernel, std::size_t batch_size, std::size_t steps) {
  std::vector<std::size_t> chains(std::max(batch_size, chain_count));
  std::vector<Model> models_of_places;
  for (std::size_t place = 0; place < chains.size(); ++place) {
    chains[place] = place % chain_count;
    models_of_places.push_back(models[chains[place]]);
  }
  Outcome outcome;
  std::vector<Hash> hashes(chains.size());
  for (std::size_t first = 0; first < chains.size(); first += batch_size) {
    const std::size_t size = std::min(batch_size, chains.size() - first);
    Batch batch(std::span<const Model>(models_of_places).subspan(first, size), &kernel);
    run_batch(batch, std::span<const std::size_t>(chains).subspan(first, size),
              std::span<Hash>(hashes).subspan(first, size), steps, outcome);
    for (std::size_t place = 0; place < size; ++place) {
      outcome.failures += batch.failed(place) ? 1U : 0U;
    }
  }
  for (std::size_t place = 0; place < chains.size(); ++place) {
    if (place < chain_count) {
      outcome.state.add(hashes[place].value());
    } else if (hashes[place].value() != hashes[chains[place]].value()) {
      ++outcome.failures;
    }
  }
  return outcome;
}

/// Two lines, each with these words in front.
void print(std::FILE* file, const std::string& start, const ChainKernel& kernel, std::size_t batch_size,
           std::size_t steps) {
  const auto print_line = [&](const char* name, const Outcome& outcome) {
    std::fprintf(file, "%s%s\t%lu\t%lu\t%lu\t%lu\t%lu\t%016llx\n", start.c_str(), name,
                 static_cast<unsigned long>(steps), outcome.failures, outcome.on_terrain, outcome.on_itself,
                 outcome.weak_motors, static_cast<unsigned long long>(outcome.state.value()));
  };
  print_line("plane", run<ChainBatch<Planar>>(make_chains(), kernel, batch_size, steps));
  print_line("space", run<ChainBatch<Spatial>>(make_snakes(), kernel, batch_size, steps));
}

int write_golden(const char* name) {
  std::FILE* file = std::fopen(name, "w");
  if (file == nullptr) {
    std::fprintf(stderr, "reduced_golden: %s: cannot write\n", name);
    return 1;
  }
  std::fputs("chains\tsteps\tfailures\ton_terrain\ton_itself\tweak_motors\tstate_fnv1a\n", file);
  for (const std::size_t steps : golden_steps) {
    print(file, "", base_kernel, chain_count, steps);
  }
  if (std::fclose(file) != 0) {
    std::fprintf(stderr, "reduced_golden: %s: cannot write\n", name);
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count == 3 && std::string_view(arguments[1]) == "--write-golden") {
    return write_golden(arguments[2]);
  }
  std::vector<std::size_t> numbers;
  for (const char* argument : std::span(arguments, static_cast<std::size_t>(argument_count)).subspan(1)) {
    numbers.push_back(std::strtoul(argument, nullptr, 10));
  }
  if (numbers.empty() || std::ranges::count(numbers, 0U) > 0) {
    std::fputs("reduced_golden: found other arguments, expected STEPS [SIZE]... or --write-golden FILE\n", stderr);
    return 2;
  }
  const std::size_t steps = numbers.front();
  numbers.erase(numbers.begin());
  if (numbers.empty()) {
    numbers.assign(std::begin(batch_sizes), std::end(batch_sizes));
  }
  for (const ChainKernel* kernel : supported_kernels()) {
    for (const std::size_t size : numbers) {
      print(stdout, std::string(kernel->instructions) + "\t" + std::to_string(size) + "\t", *kernel, size, steps);
    }
  }
  return 0;
}
