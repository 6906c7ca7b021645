#include "sim/scenario/input_error.hpp"

#include "sim/scenario/text.hpp"

namespace proleg::sim {

InputError::InputError(const std::string& file, int line, const std::string& found, const std::string& expected)
    : std::runtime_error(one_line(file + (line > 0 ? ":" + std::to_string(line) : std::string()) + ": found " + found +
                                  ", expected " + expected)) {}

}  // namespace proleg::sim
