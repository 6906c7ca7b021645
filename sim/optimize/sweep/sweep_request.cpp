#include "sim/optimize/sweep/sweep_request.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view format_line = "format\tproleg sweep 1";

/// Where the file has a single value.
std::string* single_value(SweepRequest& request, std::string_view name) {
  struct Member {
    std::string_view name;
    std::string SweepRequest::*value;
  };
  constexpr Member members[] = {{"started", &SweepRequest::started},
                                {"folder", &SweepRequest::folder},
                                {"scenario", &SweepRequest::scenario},
                                {"measure", &SweepRequest::measure}};
  for (const Member& member : members) {
    if (member.name == name) {
      return &(request.*member.value);
    }
  }
  return nullptr;
}

/// Whether the file may have this value.
bool take(SweepRequest& request, std::string_view name, std::string_view value) {
  if (std::string* const single = single_value(request, name)) {
    *single = value;
    return true;
  }
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (declaration.name == name) {
      request.overrides.*declaration.word = std::string(value);
      return true;
    }
  }
  if (name == "seconds") {
    request.seconds = std::string(value);
  } else if (name == "over") {
    request.over.emplace_back(value);
  } else if (name == "unit") {
    request.units.emplace_back(value);
  } else if (name == "set") {
    request.settings.emplace_back(value);
  } else {
    return false;
  }
  return true;
}

}  // namespace

std::string sweep_request_text(const SweepRequest& request) {
  std::string text = std::string(format_line) + '\n';
  const auto add = [&text](std::string_view name, const std::string& value) {
    text.append(name).append("\t").append(one_line(value)).append("\n");
  };
  add("started", request.started);
  add("folder", request.folder);
  add("scenario", request.scenario);
  add("measure", request.measure);
  for (std::size_t i = 0; i < request.over.size(); ++i) {
    add("over", request.over[i]);
    add("unit", request.units[i]);
  }
  for (const std::string& setting : request.settings) {
    add("set", setting);
  }
  if (request.seconds) {
    add("seconds", *request.seconds);
  }
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = request.overrides.*declaration.word) {
      add(declaration.name, *word);
    }
  }
  return text;
}

SweepRequest read_sweep_request(const std::string& name, std::string_view text) {
  SweepRequest request;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const std::size_t tab = line.find('\t');
    const bool is_known = number == 1 ? line == format_line
                                      : tab != std::string_view::npos && end != std::string_view::npos &&
                                            take(request, line.substr(0, tab), line.substr(tab + 1));
    if (!is_known) {
      throw InputError(name, number, in_quotes(one_line(shortened(std::string(line)))),
                       number == 1 ? in_quotes(one_line(format_line)) : "an option of a sweep of this version");
    }
  }
  if (request.over.empty() || request.over.size() != request.units.size() || request.scenario.empty() ||
      request.measure.empty()) {
    throw InputError(name, 0, "the end of the file", "scenario, measure and quantities of a sweep");
  }
  return request;
}

std::vector<std::string> words_of(const SweepRequest& request) {
  std::vector<std::string> words{request.scenario, "--measure", request.measure};
  for (const std::string& over : request.over) {
    words.insert(words.end(), {"--over", over});
  }
  for (const std::string& setting : request.settings) {
    words.insert(words.end(), {"--set", setting});
  }
  if (request.seconds) {
    words.insert(words.end(), {"--seconds", *request.seconds});
  }
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = request.overrides.*declaration.word) {
      words.insert(words.end(), {"--" + std::string(declaration.name), *word});
    }
  }
  return words;
}

}  // namespace proleg::optimize
