#include "shared/canopen/object_name.hpp"

#include "shared/canopen/objects.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::canopen {
namespace {

void append(ObjectName& name, std::string_view text) {
  for (const char character : text) {
    if (name.size < name.characters.size()) {
      name.characters[name.size++] = character;
    }
  }
}

/// Appends a blank and a number, such as " 12"; the number is below 100.
void append_number(ObjectName& name, unsigned number) {
  const std::array<char, 3> digits{' ', static_cast<char>('0' + number / 10U), static_cast<char>('0' + number % 10U)};
  append(name, {digits.data(), 1});
  append(name, number < 10 ? std::string_view(&digits[2], 1) : std::string_view(&digits[1], 2));
}

/// Name of the parameter or internal value, such as "amplitude".
std::string_view short_name(const ValueAddress& value) {
  const Declaration& declaration = find_algorithm(value.algorithm)->declaration();
  return value.kind == ValueKind::internal_value ? declaration.internal_values[value.number].name
                                                 : declaration.parameters[value.number].name;
}

void append_value_name(ObjectName& name, const ValueAddress& value) {
  append(name, find_algorithm(value.algorithm)->declaration().name);
  append(name, " ");
  append(name, short_name(value));
  if (value.kind == ValueKind::staged_parameter) {
    append(name, ", staged");
  }
}

void append_slot(ObjectName& name, const ValueAddress& value) {
  append(name, "slot");
  append_number(name, value.slot + 1U);
}

}  // namespace

ObjectName index_name(std::uint16_t index) {
  ObjectName name{};
  if (const ObjectGroup* group = find_group(index)) {
    append(name, group->name);
    if (group->count > 1) {
      append_number(name, static_cast<unsigned>(index - group->index));
    }
  } else if (find_row({index, 0}) != nullptr) {
    append(name, find_object({index, 0})->name);
  } else if (const std::optional<ValueAddress> value = value_address({index, 1})) {
    append_value_name(name, *value);
  }
  return name;
}

ObjectName entry_name(Address address) {
  ObjectName name{};
  if (const std::optional<ValueAddress> value = value_address(address)) {
    // Tools list entries without the name of their index, so the slot alone would not be clear.
    append(name, short_name(*value));
    append(name, value->kind == ValueKind::staged_parameter ? ", staged, of " : " of ");
    append_slot(name, *value);
  } else if (const std::optional<Object> object = find_object(address)) {
    append(name, object->name);
    if (const EntryRow* row = find_row(address); row != nullptr && row->subs > 1) {
      append_number(name, static_cast<unsigned>(address.sub - row->first.sub) + 1U);
    }
  }
  return name;
}

ObjectName full_name(Address address) {
  const ObjectName entry = entry_name(address);
  const std::optional<IndexInfo> info = find_index(address.index);
  if (entry.size == 0 || !info || info->code == ObjectCode::variable) {
    return entry;
  }
  ObjectName name = index_name(address.index);
  append(name, ": ");
  if (const std::optional<ValueAddress> value = value_address(address)) {
    append_slot(name, *value);
  } else {
    append(name, entry.view());
  }
  return name;
}

}  // namespace proleg::canopen
