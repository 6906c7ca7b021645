#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

/// Calls use(column, cell) for each cell of a line of a table.
template <typename Use>
void for_each_cell(std::string_view line, const Use& use) {
  line = line.substr(0, line.find('\n'));
  for (std::size_t column = 0;; ++column) {
    const std::size_t tab = line.find('\t');
    use(column, line.substr(0, tab));
    if (tab == std::string_view::npos) {
      return;
    }
    line.remove_prefix(tab + 1);
  }
}

py::dict read_recording(const std::string& path) {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<std::pair<std::string, std::string>> results;
  bool finished = false;
  {
    const Unlocked unlocked;
    SignalWatch watch;
    const sim::Recording recording(path);
    finished = recording.finished();
    results = recording.results();
    sim::write_tsv(recording, [&](std::string_view line) {
      if (names.empty()) {
        for_each_cell(line, [&](std::size_t /*column*/, std::string_view cell) { names.emplace_back(cell); });
        columns.resize(names.size());
        return;
      }
      for_each_cell(line, [&](std::size_t column, std::string_view cell) {
        columns.at(column).push_back(parse_number(cell).value_or(std::numeric_limits<double>::quiet_NaN()));
      });
      watch.check();
    });
  }
  py::dict table;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t rows = columns[i].size();
    table[py::str(names[i])] = array_of(std::move(columns[i]), {rows});
  }
  py::dict recording;
  recording["table"] = table;
  recording["results"] = results;
  recording["finished"] = finished;
  return recording;
}

}  // namespace

void add_recording(py::module_& module) { module.def("read_recording", &read_recording, py::arg("path")); }

}  // namespace proleg::python
