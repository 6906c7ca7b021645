#pragma once

// A draft in memory for tests: the small scenario, with a world of all kinds of objects.

#include <string>

#include "memory_files.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/authoring/world_change.hpp"

namespace proleg::sim {

inline constexpr const char* world_text = R"(<Environment>
  <!-- This comment stays. -->
  <physicsengine type="ode"><odeproperties><gravity>0 0 -9.81</gravity></odeproperties></physicsengine>
  <KinBody name="floor">
    <Body type="static">
      <Translation>0 0 -0.003</Translation>
      <Geom type="box"><extents>1000 1000 0.003</extents><friction>0.1</friction></Geom>
    </Body>
  </KinBody>
  <KinBody name="stairs">
    <translation>0 1 0</translation>
    <rotationaxis>0 0 1 90</rotationaxis>
    <Body type="static" name="low">
      <translation>0 0.1 0.015</translation>
      <Geom type="box">
        <extents>0.5 0.1 0.015</extents>
        <diffuseColor>0.6 0.5 0.4</diffuseColor>
      </Geom>
    </Body>
    <Body type="static" name="high">
      <translation>0 0.3 0</translation> <translation>0 0 0.03</translation>
      <quat>1 0 0 0</quat>
      <rotationaxis>1 0 0 10</rotationaxis>
      <Geom type="box"><extents>0.5 0.1 0.03</extents></Geom>
      <Geom type="sphere"><radius>0.02</radius><friction>0.3</friction></Geom>
    </Body>
  </KinBody>
  <KinBody file="pole.xml" name="pole"/>
  <KinBody name="ball"><Body type="dynamic"><Translation>1 1 0.05</Translation><Geom type="sphere"><radius>0.05</radius></Geom><Mass type="mimicgeom"><density>100</density></Mass></Body></KinBody>
  <ruler><from>0 0 0</from><to>0 3 0</to></ruler>
</Environment>
<!--Pose: ,0 0 0.03,0 0 45,-->
)";

[[nodiscard]] inline MemoryFiles world_files() {
  MemoryFiles files = small_scenario();
  files.texts["environment.xml"] = world_text;
  files.texts["pole.xml"] = R"(<KinBody><Body type="static"><Translation>2 0 0.5</Translation>
<Geom type="cylinder"><radius>0.05</radius><height>1</height></Geom></Body></KinBody>
)";
  return files;
}

/// Changes the world of a draft.
template <typename Change>
void change_world(Draft& draft, const Change& change, std::optional<std::uint64_t> gesture = {}) {
  const WorldContents world = read_world_contents(draft);
  draft.change("test", gesture, [&](DraftChange& edit) {
    WorldChange world_change(world, edit);
    change(world_change);
  });
}

[[nodiscard]] inline std::string text_of(const Draft& draft, const std::string& file) { return draft.text(file); }

}  // namespace proleg::sim
