#pragma once

namespace proleg::host {

enum class NoticeLevel { info, warning, error };

}  // namespace proleg::host
