#include <gtest/gtest.h>

#include <map>

#include "experiment_files.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

std::string fingerprint(MemoryFiles files) { return read(files).fingerprint(); }

MemoryFiles with(const std::string& file, const std::string& old_text, const std::string& new_text) {
  MemoryFiles files = small_experiment();
  return files.replace(file, old_text, new_text);
}

TEST(Fingerprint, Is64HexadecimalDigits) {
  const std::string text = fingerprint(small_experiment());
  EXPECT_EQ(text.size(), 64U);
  EXPECT_EQ(text.find_first_not_of("0123456789abcdef"), std::string::npos);
}

TEST(Fingerprint, LeavesOutTheBudgetAndHowTheFileIsWritten) {
  const std::string same = fingerprint(small_experiment());
  EXPECT_EQ(fingerprint(with("top.optimise.xml", "<evaluations>100", "<evaluations>200")), same);
  EXPECT_EQ(fingerprint(with("top.optimise.xml", "<genome>", "<!-- a remark -->\n\n<genome>")), same);
  EXPECT_EQ(fingerprint(with("top.optimise.xml", "<upperBounds>40", "<upperBounds>4e1")), same);
}

TEST(Fingerprint, LeavesOutWhereTheFilesAre) {
  MemoryFiles elsewhere;
  for (const auto& [name, text] : small_experiment().texts) {
    elsewhere.texts["folder/" + name] = text;
  }
  EXPECT_EQ(read_experiment("folder/top.optimise.xml", elsewhere).fingerprint(), fingerprint(small_experiment()));
}

TEST(Fingerprint, ChangesWithEverySetting) {
  const std::string file = "top.optimise.xml";
  std::map<std::string, std::string> by_fingerprint{{fingerprint(small_experiment()), "the experiment itself"}};
  const auto expect_new = [&](const MemoryFiles& files, const std::string& what) {
    const auto [other, is_new] = by_fingerprint.emplace(fingerprint(files), what);
    EXPECT_TRUE(is_new) << what << " has the fingerprint of " << other->second;
  };
  const std::vector<std::pair<std::string, std::string>> changes{
      {"<waterLevel>0.1", "<waterLevel>0.2"},
      {"<waterLevel>0.1", "<rain>0.02</rain><waterLevel>0.1"},
      {"<waterLevel>0.1", "<credits>9</credits><waterLevel>0.1"},
      {"<waterLevel>0.1", "<retries>9</retries><waterLevel>0.1"},
      {"<waterLevel>0.1", "<confidence>9</confidence><waterLevel>0.1"},
      {"<waterLevel>0.1", "<step>9</step><waterLevel>0.1"},
      {"<waterLevel>0.1", "<growth>linear</growth><waterLevel>0.1"},
      {"<waterLevel>0.1", "<move>one</move><waterLevel>0.1"},
      {"<waterLevel>0.1", "<neighbour>sign</neighbour><waterLevel>0.1"},
      {"<waterLevel>0.1", "<start>scenario</start><waterLevel>0.1"},
      {"<waterLevel>0.1", "<firstMustPass>0</firstMustPass><waterLevel>0.1"},
      {"<waterLevel>0.1", "<reevaluations>1</reevaluations><waterLevel>0.1"},
      {"<waterLevel>0.1", "<chains>2</chains><waterLevel>0.1"},
      {"<waterLevel>0.1", "<target>0</target><waterLevel>0.1"},
      {"<upperBounds>40", "<upperBounds>40.5"},
      {"parameter=\"amplitude\"", "parameter=\"offset\""},
      {"<uniform>0", "<uniform>1"},
      {"heading=\"0\"", "heading=\"1\""},
      {"measure=\"distance\"", "measure=\"speed\" failed=\"0\""},
      {"measure=\"distance\"", "measure=\"distance\" failed=\"1\""},
      {"measure=\"distance\"", "measure=\"distance\" name=\"d\""},
      {"<seed>5", "<seed>6"},
      {"<reuse>1", "<reuse>0"},
      {"count=\"2\"", "count=\"3\""},
      {"\"mean\"", "\"worst\""},
      {"aggregate=\"mean\"", "randomNumbers=\"fresh\""},
      {"<reuse>1", "<confirmation candidates=\"4\"/><reuse>1"},
      {"<reuse>1", "<confirmation runs=\"9\"/><reuse>1"},
      {"<friction>0.1", "<friction>0.2"},
      {"<friction>0.1</friction>", "<mass>0.1</mass>"},
      {"<friction>0.1</friction>", "<servoGain>0.1</servoGain>"},
      {"<friction>0.1</friction>", "<contactNoise>0.1</contactNoise>"},
      {">20<", ">21<"},
      {"after=\"0.3\"", "after=\"0.4\""},
      {"keep=\"0.5\"", "keep=\"0.6\""}};
  for (const auto& [old_text, new_text] : changes) {
    expect_new(with(file, old_text, new_text), new_text);
  }
  expect_new(with("robot.xml", "<gain>20", "<gain>21"), "another robot");
  expect_new(with("top.xml", "<duration>2", "<duration>3"), "another duration");
}

TEST(Fingerprint, ChangesWithTheMethod) {
  MemoryFiles genetic = small_experiment();
  std::map<std::string, std::string> by_fingerprint;
  for (const std::string tag :
       {"geneticAlgorithm", "greatDeluge", "cmaEs", "nsga2", "pagmo algorithm=\"sade\"", "pagmo algorithm=\"pso\""}) {
    MemoryFiles files = small_experiment();
    files.replace("top.optimise.xml", "<greatDeluge>", "<" + tag + ">");
    files.replace("top.optimise.xml", "</greatDeluge>", "</" + tag.substr(0, tag.find(' ')) + ">");
    files.replace("top.optimise.xml", "<waterLevel>0.1</waterLevel>", "");
    const auto [other, is_new] = by_fingerprint.emplace(fingerprint(files), tag);
    files.replace("top.optimise.xml", "<numOf", "<start>random</start><numOf");
    EXPECT_EQ(by_fingerprint.emplace(fingerprint(files), tag).second, tag != "greatDeluge") << "random is its default";
    EXPECT_TRUE(is_new) << tag << " has the fingerprint of " << other->second;
  }
}

TEST(Fingerprint, ChangesWithWhatTheCommandLineSets) {
  MemoryFiles files = small_experiment();
  Experiment experiment = read(files);
  const std::string before = experiment.fingerprint();
  sim::apply_setting(experiment.scenario, "frequency=0.5");
  const std::string with_setting = experiment.fingerprint();
  EXPECT_NE(with_setting, before);
  sim::apply_setting(experiment.scenario, "frequency=0.25@7");
  EXPECT_NE(experiment.fingerprint(), with_setting);
  experiment = read(files);
  experiment.scenario.duration_s = 1.0;
  EXPECT_NE(experiment.fingerprint(), before);
}

}  // namespace
}  // namespace proleg::optimize
