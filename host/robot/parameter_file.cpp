#include "host/robot/parameter_file.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "host/robot/object_word.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::host {
namespace {

constexpr std::string_view first_line = "# Proleg parameters 1";
constexpr std::string_view module_word = "module";

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t tab = line.find('\t');
    fields.push_back(trimmed(line.substr(0, tab)));
    if (tab == std::string_view::npos) {
      return fields;
    }
    line = line.substr(tab + 1);
  }
}

std::optional<std::uint8_t> parse_node(std::string_view word) {
  const auto node = parse_whole<std::uint8_t>(word);
  return node && *node >= canopen::min_node_id && *node <= canopen::max_node_id ? node : std::nullopt;
}

std::optional<std::uint32_t> parse_hexadecimal(std::string_view word) {
  return word.starts_with("0x") ? parse_whole<std::uint32_t>(word.substr(2), 16) : std::nullopt;
}

/// Reads the file line by line.
class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  void take(std::string_view line, int number) {
    line_ = number;
    if (line_ == 1) {
      if (words(line) != words(first_line)) {
        refuse(in_quotes(line), "'" + std::string(first_line) + "'");
      }
      return;
    }
    if (trimmed(line).empty() || line.starts_with('#')) {
      return;
    }
    const std::vector<std::string_view> fields = fields_of(line);
    if (fields.front() == module_word) {
      take_module(fields);
    } else {
      take_value(fields);
    }
  }

  [[nodiscard]] std::vector<ModuleParameters> finish() {
    if (line_ == 0) {
      refuse("an empty file", "'" + std::string(first_line) + "'");
    }
    return std::move(modules_);
  }

 private:
  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw InputError(file_, line_, found, expected);
  }

  void take_module(const std::vector<std::string_view>& fields) {
    if (fields.size() != 4) {
      refuse(std::to_string(fields.size()) + " fields", "module, node, serial number and core fingerprint, with tabs");
    }
    const auto node = parse_node(fields[1]);
    const auto serial = parse_hexadecimal(fields[2]);
    const auto fingerprint = parse_hexadecimal(fields[3]);
    if (!node) {
      refuse("node " + in_quotes(fields[1]), "1 to 126");
    }
    if (!serial || !fingerprint) {
      refuse(in_quotes(serial ? fields[3] : fields[2]), "eight hexadecimal digits after 0x");
    }
    if (std::ranges::find(modules_, *node, &ModuleParameters::node) != modules_.end()) {
      refuse("node " + std::to_string(*node) + " twice", "each node once");
    }
    modules_.push_back({*node, *serial, *fingerprint, {}});
  }

  void take_value(const std::vector<std::string_view>& fields) {
    if (fields.size() < 3) {
      refuse(std::to_string(fields.size()) + " fields", "node, object and value, with tabs");
    }
    const auto node = parse_node(fields[0]);
    if (!node || modules_.empty() || modules_.back().node != *node) {
      refuse("node " + in_quotes(fields[0]), "the node of the 'module' line before");
    }
    std::optional<ParameterValue> value;
    try {
      const ObjectWord word(fields[1]);
      value = {word.object(), parse_value(std::string(fields[1]), word.object(), fields[2])};
    } catch (const InputError& error) {
      refuse(in_quotes(fields[1]) + " " + in_quotes(fields[2]),
             std::string("an object and its value: ") + error.what());
    }
    std::vector<ParameterValue>& values = modules_.back().values;
    const auto is_same = [&](const ParameterValue& one) { return one.object.address == value->object.address; };
    if (std::ranges::any_of(values, is_same)) {
      refuse(in_quotes(fields[1]) + " twice for node " + std::to_string(*node), "each object once");
    }
    values.push_back(*value);
  }

  std::string file_;
  int line_ = 0;
  std::vector<ModuleParameters> modules_;
};

/// The text of the value without its name, as `proleg set` accepts it.
std::string plain_value(const ParameterValue& value) {
  const std::string text = value_text(value.object, value.bytes);
  return text.substr(0, text.find(' '));
}

}  // namespace

std::vector<ModuleParameters> read_parameters(const std::string& file, std::string_view text) {
  Reader reader(file);
  TextLines lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    reader.take(*line, lines.number());
  }
  return reader.finish();
}

std::string parameters_text(const std::vector<ModuleParameters>& modules) {
  std::string text = std::string(first_line) + '\n';
  for (const ModuleParameters& module : modules) {
    const std::string node = std::to_string(module.node);
    text += "\n" + std::string(module_word) + '\t' + node + '\t' + hexadecimal(module.serial, 8) + '\t' +
            hexadecimal(module.core_fingerprint, 8) + '\n';
    for (const ParameterValue& value : module.values) {
      const canopen::Address address = value.object.address;
      text += node + '\t' + address_text(address) + '\t' + plain_value(value) + '\t' +
              std::string(canopen::entry_name(address).view()) + '\n';
    }
  }
  return text;
}

std::vector<canopen::Object> setting_objects(const std::vector<std::uint8_t>& algorithms) {
  namespace object = canopen::object;
  std::vector<canopen::Object> objects;
  canopen::for_each_object([&](const canopen::Object& one) {
    const unsigned index = one.address.index;
    const bool is_setting = index == object::current_limit.address.index || index == object::board.index ||
                            index == object::position_limits.index || index == object::command_speed.address.index;
    const bool is_count = one.address.sub == 0 && canopen::find_group(one.address.index) != nullptr;
    if (is_setting && !is_count && one.access == canopen::Access::read_write) {
      objects.push_back(one);
    }
  });
  for (std::size_t slot = 0; slot < algorithms.size(); ++slot) {
    const ActuationModule* algorithm = find_algorithm(algorithms[slot]);
    if (algorithm == nullptr) {
      continue;
    }
    for (std::size_t number = 0; number < algorithm->declaration().parameters.size(); ++number) {
      const canopen::ValueAddress value{canopen::ValueKind::parameter, algorithms[slot],
                                        static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(slot)};
      objects.push_back(canopen::find_object(canopen::address_of(value)).value());
    }
  }
  return objects;
}

std::vector<canopen::Object> kept_objects() {
  std::vector<canopen::Object> objects = setting_objects({});
  std::erase_if(objects, [](const canopen::Object& one) {
    return one.address.index == canopen::object::command_speed.address.index;
  });
  return objects;
}

}  // namespace proleg::host
