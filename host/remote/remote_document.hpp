#pragma once

#include <nlohmann/json.hpp>

#include "host/remote/remote_control.hpp"

namespace proleg::host {

/// The members `devices`, `bindings`, `problems`, `learning` and `active` of the document `remote`
/// (docs/page-interface.md).
[[nodiscard]] nlohmann::json remote_document(const RemoteControl& remote);

/// The document `remote_values`: positions of elements, and the values that bindings make of them.
[[nodiscard]] nlohmann::json remote_values_document(const RemoteControl& remote);

}  // namespace proleg::host
