#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/module_change.hpp"
#include "sim/authoring/world_change.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/mesh_session.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

SentMeshes::Mesh sent_mesh(const json& words, const SentMeshes& meshes) {
  const auto sent = argument<std::uint64_t>(words, "mesh", "the number of a mesh");
  return meshes.at(sent.value_or(0));
}

sim::MeshFit mesh_fit(const json& words) {
  sim::MeshFit fit;
  fit.factor = number(words, "factor");
  if (const std::vector<std::size_t> quarters = positions(words, "quarters"); !quarters.empty()) {
    if (quarters.size() != fit.quarter_turns.size()) {
      throw InputError("quarters", 0, std::to_string(quarters.size()) + " numbers", "three: about x, y and z");
    }
    for (std::size_t axis = 0; axis < quarters.size(); ++axis) {
      fit.quarter_turns.at(axis) = static_cast<unsigned>(quarters[axis]);
    }
  }
  if (!numbers(words, "colour").empty()) {
    fit.colour = vector(words, "colour");
  }
  require_fit(fit);
  return fit;
}

DraftOperation add_mesh(const json& words, const sim::Draft& draft, const SentMeshes& meshes) {
  const SentMeshes::Mesh mesh = sent_mesh(words, meshes);
  auto world = std::make_shared<const sim::WorldContents>(read_world_contents(draft));
  return {"add " + mesh->files.front().name,
          [mesh, world, fit = mesh_fit(words), is_sheet = is_set(words, "sheet"), position = vector(words, "position"),
           turn = argument<double>(words, "turn", "degrees").value_or(0.0)](sim::DraftChange& edit) {
            sim::WorldChange(*world, edit).add_mesh(*mesh, fit, is_sheet, position, turn);
          }};
}

/// The links, or all of them, become modules of a new kind.
DraftOperation own_module(const json& words, const sim::Draft& draft, const SentMeshes& meshes) {
  const SentMeshes::Mesh mesh = sent_mesh(words, meshes);
  const sim::OwnModule module{text(words, "name"), mesh_fit(words), number(words, "length"), number(words, "mass")};
  const auto taken = sim::own_kinds(draft.scenario());
  if (std::ranges::find(taken, module.name, &sim::ModuleKind::name) != taken.end()) {
    throw InputError("name", 0, in_quotes(module.name), "a new name: the draft has a kind of this name");
  }
  auto kind = std::make_shared<const sim::ModuleKind>(own_module_kind(*mesh, module));
  return {"modules " + module.name,
          [kind, links = links_from_tail(positions(words, "links"), draft)](sim::DraftChange& edit) {
            sim::set_kind_of_links(edit, *kind, links);
          },
          true};
}

using MeshOperationReader = DraftOperation (*)(const json&, const sim::Draft&, const SentMeshes&);

const std::map<std::string_view, MeshOperationReader>& mesh_readers() {
  static const std::map<std::string_view, MeshOperationReader> readers{{"robot.own_module", own_module},
                                                                       {"world.add_mesh", add_mesh}};
  return readers;
}

}  // namespace

bool names_sent_mesh(std::string_view operation) { return mesh_readers().contains(operation); }

DraftOperation mesh_operation(const std::string& name, const json& arguments, const sim::Draft& draft,
                              const SentMeshes& meshes) {
  return handler_of(mesh_readers(), name)(arguments, draft, meshes);
}

}  // namespace proleg::tools
