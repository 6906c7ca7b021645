#include "shared/computer/errors/input_error.hpp"

#include "shared/computer/text/text.hpp"

namespace proleg {

InputError::InputError(const std::string& file, int line, const std::string& found, const std::string& expected)
    : std::runtime_error(one_line(file + (line > 0 ? ":" + std::to_string(line) : std::string()) + ": found " + found +
                                  ", expected " + expected)) {}

}  // namespace proleg
