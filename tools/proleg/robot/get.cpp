// proleg get: reads objects of modules.

#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "host/robot/object_word.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct GetOptions : BusOptions {
  std::string nodes;
  std::vector<std::string> objects;
  bool json = false;
};

struct Reading {
  std::uint8_t node;
  canopen::Object object;
  host::SdoResult result;
};

int get(const GetOptions& options) {
  static_cast<void>(host::parse_nodes(options.nodes));
  std::vector<host::ObjectWord> words;
  for (const std::string& object : options.objects) {
    words.emplace_back(object);
  }
  BusAccess bus(options);
  catch_interrupts();
  const std::vector<std::uint8_t> nodes = nodes_of(bus, options.nodes);
  host::SdoQueue queue(bus.connection(), patient_transfers());
  const AlgorithmTable algorithms = read_algorithms(bus, queue, nodes, words);
  std::vector<Reading> readings;
  readings.reserve(nodes.size() * words.size());
  for (const std::uint8_t node : nodes) {
    for (const host::ObjectWord& word : words) {
      readings.push_back({node, algorithms.object(node, word), {}});
      queue.read(
          node, readings.back().object.address,
          [&readings, place = readings.size() - 1](const host::SdoResult& result) { readings[place].result = result; });
    }
  }
  finish(bus, queue);

  int status = exit_success;
  Json list = Json::empty_array();
  for (const Reading& reading : readings) {
    const std::string name(canopen::entry_name(reading.object.address).view());
    const std::string address = host::address_text(reading.object.address);
    if (!reading.result.is_good()) {
      std::cerr << "proleg get: "
                << failure_text(reading.node, std::string(address).append(" (").append(name).append(")"),
                                reading.result.abort_code, bus.connection().diagnosis())
                << '\n';
      status = exit_failed;
      continue;
    }
    const std::string value = host::value_text(reading.object, reading.result.value);
    if (options.json) {
      list.append(
          {{"node", unsigned{reading.node}},
           {"object", address},
           {"name", name},
           {"value", value},
           {"raw", canopen::is_long(reading.object.type) ? Json() : Json(raw_number(reading.object, reading.result))}});
    } else {
      std::cout << "node " << unsigned{reading.node} << "  " << address << "  " << name << " = " << value << '\n';
    }
  }
  if (options.json) {
    std::cout << Json{{"values", list}}.text() << '\n';
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg get", "Reads objects of modules: 'proleg get 3 amplitude 0x6064'.");
  GetOptions options;
  command_line.add_option("NODE", options.nodes, "node ids, such as 3, 1,3 or 2-5, or all").required();
  command_line
      .add_option("OBJECT", options.objects,
                  "an index such as 0x6064 or 0x1018:4, a name of 'proleg objects', or a parameter of the algorithm in "
                  "slot 1 (amplitude) or another slot (amplitude:2)")
      .takes_several()
      .required();
  add_bus_option(command_line, options);
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return get(options); });
}
