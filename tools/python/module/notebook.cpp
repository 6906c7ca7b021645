// The module proleg._notebook: pictures and players of recordings. It is a module of its own because few programs need
// it.

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

#include "sim/record/figure.hpp"
#include "sim/record/recording.hpp"
#include "tools/proleg/document/recording_document.hpp"
#include "tools/proleg/document/recording_page.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

/// What `proleg plot` draws of a recording, as SVG.
std::string picture(const std::string& recording) {
  const Unlocked unlocked;
  return sim::draw_figure(sim::Recording(recording), {});
}

/// What `proleg export --html` makes of a recording. player: player.html of tools/page.
std::string page(const std::string& path, const std::string& player) {
  const Unlocked unlocked;
  SignalWatch watch;
  const sim::Recording recording(path);
  std::string text;
  tools::write_html(
      recording, tools::scenario_of(recording), tools::PlayerPage(player),
      [&text](std::string_view part) { text += part; }, [&watch](std::uint32_t /*tick*/) { watch.check(); });
  return text;
}

}  // namespace
}  // namespace proleg::python

PYBIND11_MODULE(_notebook, module) {
  proleg::python::share_with_core(module);
  module.def("picture", &proleg::python::picture, py::arg("recording"));
  module.def("page", &proleg::python::page, py::arg("recording"), py::arg("player"));
}
