#pragma once

#include <string>

#include "memory_files.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {

using sim::MemoryFiles;

inline const std::string travelling_wave = source_path("/sim/scenarios/travelling_wave/");

/// Files in memory, and those on disk where memory has none of that name.
class FilesOverDisk final : public sim::FileSource {
 public:
  std::map<std::string, std::string> texts;

  [[nodiscard]] std::optional<sim::SharedText> read(const std::filesystem::path& path) override {
    const auto file = texts.find(path.lexically_normal().string());
    return file == texts.end() ? disk_.read(path) : std::optional<sim::SharedText>(file->second);
  }

 private:
  sim::DiskFiles disk_;
};

/// A small experiment that is valid, with the small scenario. Its robot file has the joints J1, at the tail, and J2;
/// slot 1 (sinusoidal) drives both, slot 2 (DirectJointAccess) drives J2.
inline MemoryFiles small_experiment() {
  MemoryFiles files = sim::small_scenario();
  files.texts["top.optimise.xml"] = R"(<greatDeluge>
  <simulation>top.xml</simulation>
  <properties>
    <waterLevel>0.1</waterLevel>
    <numOfParametersToOptimize>2</numOfParametersToOptimize>
    <registeredParameters>
      <parameter number="0" controlAlgorithm="PatternGenerator_sinusoidal" parameter="amplitude"/>
      <parameter number="1" controlAlgorithm="DirectJointAccess" parameter="angle"/>
    </registeredParameters>
  </properties>
  <genome>
    <genomeConfig number="0" allJoints="1" genomeType="1" valueType="1" valueSpace="1" activeJoints="11">
      <upperBounds>40</upperBounds>
      <lowerBounds>10</lowerBounds>
      <boundsIncrements>0.5</boundsIncrements>
      <lowerBoundTypes>1</lowerBoundTypes>
      <upperBoundTypes>1</upperBoundTypes>
      <uniform>0</uniform>
    </genomeConfig>
    <genomeConfig number="1" allJoints="0" genomeType="1" valueType="1" valueSpace="0" activeJoints="01">
      <values>0 -5.5 12</values>
      <uniform>1</uniform>
    </genomeConfig>
  </genome>
  <fitness heading="0">
    <objective measure="distance"/>
  </fitness>
  <evaluation>
    <evaluations>100</evaluations>
    <seed>5</seed>
    <reuse>1</reuse>
    <trials count="2" aggregate="mean">
      <friction>0.1</friction>
      <latency unit="ms">20</latency>
    </trials>
    <racing after="0.3" keep="0.5"/>
  </evaluation>
</greatDeluge>
)";
  return files;
}

inline Experiment read(MemoryFiles& files) { return read_experiment("top.optimise.xml", files); }

/// The small experiment with one text, which must be there once, replaced.
inline Experiment read_with(const std::string& old_text, const std::string& new_text) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml", old_text, new_text);
  return read(files);
}

inline std::string message_of(MemoryFiles& files) {
  try {
    static_cast<void>(read(files));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace proleg::optimize
