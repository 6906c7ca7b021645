// proleg set: writes an object of modules.

#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "host/robot/object_word.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct SetOptions : BusOptions {
  std::string nodes;
  std::string object;
  std::string value;
  bool verbose = false;
};

/// A servo period that burns real servos: throws InputError. Others go to the module.
void require_servo_period(const SetOptions& options, const canopen::Object& object,
                          std::span<const std::uint8_t> bytes) {
  if (object.address == canopen::object::servo_period.address &&
      read_little_endian(bytes, 0, bytes.size()) < min_real_servo_period_us &&
      can_have_real_servos(options.address())) {
    throw InputError(options.object, 0, in_quotes(options.value),
                     std::to_string(min_real_servo_period_us) +
                         " us or more: a real servo needs 2.5 ms for a pulse and a pause of 0.5 ms");
  }
}

int set(const SetOptions& options) {
  static_cast<void>(host::parse_nodes(options.nodes));
  const std::vector<host::ObjectWord> words{host::ObjectWord(options.object)};
  if (!words.front().slot()) {
    // A bad value is refused before the bus is opened.
    const canopen::Object object = words.front().object();
    require_servo_period(options, object, host::parse_value(options.object, object, options.value));
  }
  BusAccess bus(options);
  catch_interrupts();
  require_no_host(bus);
  const std::vector<std::uint8_t> nodes = nodes_of(bus, options.nodes);
  host::SdoQueue queue(bus.connection(), patient_transfers());
  const AlgorithmTable algorithms = read_algorithms(bus, queue, nodes, words);
  int status = exit_success;
  for (const std::uint8_t node : nodes) {
    const canopen::Object object = algorithms.object(node, words.front());
    const std::vector<std::uint8_t> bytes = host::parse_value(options.object, object, options.value);
    const std::string name =
        host::address_text(object.address) + " (" + std::string(canopen::entry_name(object.address).view()) + ")";
    queue.write(node, object.address, bytes, [&, node, object, bytes, name](const host::SdoResult& result) {
      if (result.is_good()) {
        std::cout << "node " << unsigned{node} << "  " << name << " = " << host::value_text(object, bytes);
        if (options.verbose) {
          std::cout << "  answered after " << number_text(static_cast<double>(result.elapsed_us) * 1e-3) << " ms";
          std::cout << (result.attempts > 1 ? ", at request " + std::to_string(result.attempts) : "");
        }
        std::cout << '\n';
        return;
      }
      std::cerr << "proleg set: " << failure_text(node, name, result.abort_code, bus.connection().diagnosis()) << '\n';
      status = exit_failed;
    });
  }
  finish(bus, queue);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg set",
                           "Writes an object of modules: 'proleg set 3 amplitude 40'. A module refuses what its state "
                           "does not allow. 'proleg drive' changes parameters while a robot moves.");
  SetOptions options;
  command_line.add_option("NODE", options.nodes, "node ids, such as 3, 1,3 or 2-5, or all").required();
  command_line.add_option("OBJECT", options.object, "as for 'proleg get'").required();
  command_line.add_option("VALUE", options.value, "in the unit of the object; or the number that travels, as 0x...")
      .required();
  command_line.add_flag("--verbose", options.verbose, "print the time that each module took to answer");
  add_bus_option(command_line, options);
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return set(options); });
}
