#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {

/// Files in memory, by their normalised path.
class MemoryFiles final : public FileSource {
 public:
  std::map<std::string, std::string> texts;

  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override {
    const auto file = texts.find(path.lexically_normal().string());
    return file == texts.end() ? std::nullopt : std::optional(file->second);
  }

  /// Replaces a text, which the file must contain exactly once, so that no test changes nothing.
  MemoryFiles& replace(const std::string& file, const std::string& old_text, const std::string& new_text) {
    std::string& text = texts.at(file);
    const std::size_t at = text.find(old_text);
    if (at == std::string::npos || text.find(old_text, at + 1) != std::string::npos) {
      throw std::logic_error("'" + old_text + "' is not once in " + file);
    }
    text.replace(at, old_text.size(), new_text);
    return *this;
  }

  [[nodiscard]] Scenario scenario() { return read_scenario("top.xml", *this); }
};

/// The message with which the reader refuses a scenario; "nothing" if it does not.
[[nodiscard]] inline std::string refusal(MemoryFiles files) {
  try {
    static_cast<void>(files.scenario());
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

/// A small scenario that is valid: links Tail, Middle and Head along y, joints J1 (tail) and J2 of different axes.
[[nodiscard]] inline MemoryFiles small_scenario() {
  MemoryFiles files;
  files.texts["top.xml"] = R"(<simulation>
  <robot>robot.xml</robot>
  <actuation>actuation.xml</actuation>
  <environment>environment.xml</environment>
  <simulationProperties>
    <duration>2</duration>
    <tick unit="ms">10</tick>
    <seed>7</seed>
    <solver>direct</solver>
    <stepWidth>0.001</stepWidth>
  </simulationProperties>
</simulation>
)";
  files.texts["robot.xml"] = R"(<Robot name="small">
  <servo>
    <gain>20</gain>
    <period unit="ms">2</period>
  </servo>
  <KinBody name="body">
    <KinBody file="end.xml" prefix="Tail"/>
    <Body name="Middle">
      <Geom type="box">
        <translation>0 0.1 0</translation>
        <extents>0.01 0.1 0.02</extents>
      </Geom>
      <Mass type="mimicgeom">
        <total>0.3</total>
      </Mass>
    </Body>
    <Body name="Head">
      <translation>0 0.2 0</translation>
      <Geom type="sphere">
        <radius>0.03</radius>
      </Geom>
      <Mass type="mimicgeom">
        <density>1000</density>
      </Mass>
    </Body>
    <Joint name="J1" type="hinge">
      <body>TailEnd</body>
      <body>Middle</body>
      <offsetfrom>Middle</offsetfrom>
      <axis>2 0 0</axis>
      <maxtorque>0.4</maxtorque>
      <maxvel>4.5</maxvel>
      <limitsdeg>-45 90</limitsdeg>
    </Joint>
    <Joint name="J2" type="hinge">
      <body>Middle</body>
      <body>Head</body>
      <offsetfrom>Head</offsetfrom>
      <axis>0 0 1</axis>
      <anchor>0 0.001 0</anchor>
      <maxtorque>0.3</maxtorque>
      <maxvel>5</maxvel>
      <limits>-0.5 0.75</limits>
    </Joint>
  </KinBody>
</Robot>
)";
  files.texts["end.xml"] = R"(<KinBody name="end">
  <Body name="End" type="dynamic">
    <Geom type="cylinder">
      <radius>0.02</radius>
      <height>0.06</height>
      <friction>0.5</friction>
    </Geom>
    <Mass type="custom">
      <total>0.1</total>
      <com>0 -0.01 0</com>
      <inertia>1e-4 0 0 0 2e-4 0 0 0 3e-4</inertia>
    </Mass>
  </Body>
</KinBody>
)";
  files.texts["actuation.xml"] = R"(<actuation>
  <validRobot robotName="robot.xml"/>
  <actuationModule name="PatternGenerator_sinusoidal">
    <jointConfiguration joints="11"/>
    <parameter name="amplitude" value="30" unit="deg"/>
    <parameter name="amplitude" value="10" unit="deg" joint="J1"/>
  </actuationModule>
  <actuationModule name="DirectJointAccess">
    <jointConfiguration joints="01"/>
    <parameter name="angle" value="5"/>
  </actuationModule>
</actuation>
)";
  files.texts["environment.xml"] = R"(<Environment>
  <physicsengine type="ode">
    <odeproperties>
      <gravity>0 0 -9.81</gravity>
      <selfcollision>1</selfcollision>
    </odeproperties>
  </physicsengine>
  <KinBody name="floor">
    <Body type="static">
      <Translation>0 0 -0.5</Translation>
      <Geom type="box">
        <extents>8 8 0.5</extents>
        <friction>0.1</friction>
      </Geom>
    </Body>
  </KinBody>
</Environment>
<!--Pose: ,0 0 0.1,0 0 0,-->
)";
  return files;
}

}  // namespace proleg::sim
