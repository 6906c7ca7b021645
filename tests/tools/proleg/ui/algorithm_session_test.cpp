#include "tools/proleg/ui/algorithm_session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/gait/registry.hpp"
#include "shared/image/image_header.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class AlgorithmSessionTest : public ::testing::Test {
 protected:
  AlgorithmSessionTest() { open(); }
  void open(const std::string& refusal = "") {
    session_.reset();
    requests_.emplace();
    AlgorithmSessionOptions options{project(), refusal, [this] { ++loads_; }};
    options.verifier = folder_ / "verifier";
    session_.emplace(options, *requests_, viewers_);
  }
  [[nodiscard]] fs::path project() const {
    const fs::path folder = folder_ / "project";
    fs::create_directories(folder);
    return folder;
  }

  Viewers::Answer ask(const std::string& name, json arguments = json::object(), host::ClientId client = 1) {
    requests_->operate({++request_, name, std::move(arguments), client, "a test"});
    return viewers_.answer(request_);
  }
  json must(const std::string& name, json arguments = json::object()) {
    const Viewers::Answer answer = ask(name, std::move(arguments));
    EXPECT_TRUE(answer.is_done) << name << ": " << answer.text;
    return answer.is_done ? json::parse(answer.text) : json::object();
  }
  json form(const std::string& name, unsigned id) {
    json filled = viewers_.document("algorithm_folders")["form"];
    filled["name"] = name;
    filled["id"] = id;
    return filled;
  }
  json finished_build() {
    must("algorithm.build", {{"folder", "test_wave"}});
    return viewers_.document_when(
        "algorithm_build", [](const json& document) { return document.is_object() && document["state"] != "running"; });
  }
  /// A program in the place of `proleg verify`.
  void write_verifier(const std::string& commands) {
    const fs::path file = folder_ / "verifier";
    write_file(file, "#!/bin/sh\n" + commands);
    fs::permissions(file, fs::perms::owner_all);
  }
  json finished_check() {
    must("algorithm.check", {{"folder", "test_wave"}});
    return viewers_.document_when(
        "algorithm_check", [](const json& document) { return document.is_object() && document["state"] != "running"; });
  }
  /// Programs in the place of CMake and of the compiler for the modules.
  void write_builders(const std::string& cmake) {
    const fs::path programs = folder_ / "programs";
    fs::create_directories(programs);
    for (const auto& [name, commands] :
         {std::pair<std::string, std::string>{"cmake", cmake}, {"arm-none-eabi-g++", "exit 0"}}) {
      write_file(programs / name, "#!/bin/sh\n" + commands + "\n");
      fs::permissions(programs / name, fs::perms::owner_all);
    }
    setenv("PATH", (programs.string() + ":" + path_).c_str(), 1);
  }
  json finished_image(const std::vector<std::string>& folders) {
    must("algorithm.image", {{"folders", folders}});
    return viewers_.document_when(
        "algorithm_image", [](const json& document) { return document.is_object() && document["state"] != "running"; });
  }
  void replace(const std::string& part, const std::string& by) {
    const json source = must("algorithm.read", {{"folder", "test_wave"}});
    std::string text = source["text"];
    const std::size_t at = text.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    text.replace(at, part.size(), by);
    must("algorithm.save", {{"folder", "test_wave"}, {"version", source["version"]}, {"text", text}});
  }

  ~AlgorithmSessionTest() override { setenv("PATH", path_.c_str(), 1); }

  std::string path_ = std::getenv("PATH");
  TemporaryFolder folder_;
  Viewers viewers_;
  std::optional<SessionRequests> requests_;
  std::atomic<int> loads_ = 0;
  std::optional<AlgorithmSession> session_;
  std::uint64_t request_ = 0;
};

TEST_F(AlgorithmSessionTest, ListsWhatAScenarioCanName) {
  const json algorithms = viewers_.document("algorithms");
  ASSERT_GE(algorithms.size(), 15U);
  const auto sine = std::ranges::find_if(
      algorithms, [](const json& algorithm) { return algorithm["name"] == "PatternGenerator_sinusoidal"; });
  ASSERT_NE(sine, algorithms.end());
  EXPECT_EQ((*sine)["own"], false);
  const json amplitude = (*sine)["parameters"][0];
  EXPECT_EQ(amplitude["name"], "amplitude");
  EXPECT_EQ(amplitude["unit"], "deg");
  EXPECT_EQ(amplitude["minimum"], 0);
  EXPECT_EQ(amplitude["maximum"], quarter_turn);
  EXPECT_EQ(amplitude["scale"], 90.0 / quarter_turn);
}

TEST_F(AlgorithmSessionTest, WritesANewOneFromItsForm) {
  EXPECT_EQ(must("algorithm.create", form("my_wave", 100))["folder"], "my_wave");
  const json folders = viewers_.document("algorithm_folders")["folders"];
  ASSERT_EQ(folders.size(), 1U);
  EXPECT_EQ(folders[0]["name"], "my_wave");
  EXPECT_EQ(folders[0]["loaded"], false);
  const json source = must("algorithm.read", {{"folder", "my_wave"}});
  EXPECT_EQ(source["file"], "my_wave.cpp");
  EXPECT_EQ(source["text"], file_contents(project() / "my_wave/my_wave.cpp"));
  EXPECT_TRUE(ask("algorithm.create", form("my_wave", 101)).text.starts_with("name: found 'my_wave', the algorithm"));
  fs::create_directory(project() / "taken");
  EXPECT_TRUE(ask("algorithm.create", form("taken", 101)).text.starts_with("name: found 'taken', a folder that"));
  EXPECT_TRUE(ask("algorithm.create", form("class", 101)).text.starts_with("name: found 'class'"));
  EXPECT_TRUE(ask("algorithm.create", form("wave", 95)).text.starts_with("id: found 95"));
  EXPECT_EQ(std::distance(fs::directory_iterator(project()), fs::directory_iterator()), 2);
}

TEST_F(AlgorithmSessionTest, AFormOfTheWrongKindIsRefusedWithItsField) {
  const json good = form("my_wave", 100);
  const std::vector<std::pair<json, std::string>> cases{
      {{{"name", 1}}, "name: "},
      {{{"id", "100"}}, "id: "},
      {{{"id", 1e99}}, "id: "},
      {{{"id", 356}}, "id: found 356"},
      {{{"parameters", 1}}, "parameters: "},
      {{{"parameters", {1}}}, "parameters.0: "},
      {{{"parameters", json::array({json::object()})}}, "parameters.0.name: "},
      {{{"values", {{{"name", "a"}, {"unit", "mile"}, {"help", "x"}}}}}, "values.0.unit: found 'mile'"},
      {{{"touch", 1}}, "touch: "}};
  for (const auto& [part, begin] : cases) {
    json bad = good;
    bad.update(part);
    const Viewers::Answer answer = ask("algorithm.create", bad);
    EXPECT_FALSE(answer.is_done) << begin;
    EXPECT_TRUE(answer.text.starts_with(begin)) << begin << ": " << answer.text;
  }
  EXPECT_TRUE(fs::is_empty(project()));
}

TEST_F(AlgorithmSessionTest, SavesInPartsAndNeverOverAFileThatHasChanged) {
  must("algorithm.create", form("my_wave", 100));
  const json source = must("algorithm.read", {{"folder", "my_wave"}});
  const json begin{{"folder", "my_wave"}, {"version", source["version"]}};
  const auto part = [&](const char* text, unsigned number, bool more, host::ClientId client = 1) {
    json arguments = begin;
    arguments.update({{"text", text}, {"part", number}, {"more", more}});
    return ask("algorithm.save", arguments, client);
  };
  EXPECT_TRUE(part("int a;\n", 0, true).is_done);
  EXPECT_NE(file_contents(project() / "my_wave/my_wave.cpp"), "int a;\n") << "not before the last part";
  EXPECT_FALSE(part("int b;\n", 2, false).is_done) << "a part is missing";
  EXPECT_FALSE(part("int b;\n", 1, false).is_done) << "it begins again";
  EXPECT_TRUE(part("int a;\n", 0, true).is_done);
  EXPECT_FALSE(part("int c;\n", 1, false, 2).is_done) << "of another viewer";
  EXPECT_TRUE(part("int a;\n", 0, true).is_done);
  const Viewers::Answer saved = part("int b;\n", 1, false);
  ASSERT_TRUE(saved.is_done) << saved.text;
  EXPECT_EQ(file_contents(project() / "my_wave/my_wave.cpp"), "int a;\nint b;\n");
  const Viewers::Answer late = part("int c;\n", 0, false);
  EXPECT_EQ(late.text.substr(0, 49), "my_wave.cpp: found a file that has changed since ");
  EXPECT_EQ(file_contents(project() / "my_wave/my_wave.cpp"), "int a;\nint b;\n");
  EXPECT_FALSE(part(std::string(256 * 1024 + 1, 'x').c_str(), 0, false).is_done);
}

TEST_F(AlgorithmSessionTest, NothingOutsideOfTheProjectIsReached) {
  must("algorithm.create", form("my_wave", 100));
  fs::create_directory(folder_ / "outside");
  fs::copy(project() / "my_wave", folder_ / "outside/other", fs::copy_options::recursive);
  fs::create_directory_symlink(folder_ / "outside/other", project() / "linked");
  fs::copy(project() / "my_wave", project() / "linked_source", fs::copy_options::recursive);
  fs::remove(project() / "linked_source/my_wave.cpp");
  fs::create_symlink(folder_ / "outside/other/my_wave.cpp", project() / "linked_source/my_wave.cpp");
  must("algorithm.refresh");
  EXPECT_EQ(viewers_.document("algorithm_folders")["folders"].size(), 1U);
  for (const char* name : {"linked", "linked_source", "../outside/other", "..", ".", "", "/", "my_wave/../my_wave"}) {
    for (const char* operation : {"algorithm.read", "algorithm.build", "algorithm.check"}) {
      const Viewers::Answer answer = ask(operation, {{"folder", name}});
      EXPECT_FALSE(answer.is_done) << operation << ' ' << name;
      EXPECT_TRUE(answer.text.starts_with("folder: found")) << answer.text;
    }
  }
}

TEST_F(AlgorithmSessionTest, TheProjectCanBeTheFolderOfAnAlgorithm) {
  must("algorithm.create", form("my_wave", 100));
  const fs::path inside = project() / "my_wave";
  session_.reset();
  requests_.emplace();
  session_.emplace(AlgorithmSessionOptions{inside, "", [] {}}, *requests_, viewers_);
  const json folders = viewers_.document("algorithm_folders")["folders"];
  ASSERT_EQ(folders.size(), 1U);
  EXPECT_EQ(folders[0]["folder"], ".");
  EXPECT_EQ(folders[0]["library"], (fs::canonical(inside) / "build/my_wave.so").string());
  EXPECT_EQ(must("algorithm.read", {{"folder", "."}})["name"], "my_wave");
  EXPECT_EQ(AlgorithmFolders(inside).with_name("my_wave")->folder, ".");
  EXPECT_FALSE(AlgorithmFolders(inside).with_name("other").has_value());
}

TEST_F(AlgorithmSessionTest, WithoutPermissionEverythingIsRefused) {
  must("algorithm.create", form("my_wave", 100));
  open("no code here");
  EXPECT_EQ(viewers_.document("algorithm_folders")["refusal"], "no code here");
  EXPECT_EQ(viewers_.document("algorithm_folders")["folders"], json::array());
  for (const char* operation : {"refresh", "read", "create", "save", "build", "check", "image", "cancel"}) {
    const Viewers::Answer answer = ask(std::string("algorithm.") + operation, {{"folder", "my_wave"}});
    EXPECT_FALSE(answer.is_done);
    EXPECT_EQ(answer.text, "no code here") << operation;
  }
}

TEST_F(AlgorithmSessionTest, AProofIsShownStepByStepAndThenWhole) {
  must("algorithm.create", form("test_wave", 126));
  write_verifier(
      "echo \"proleg verify: 3 of 17: building with g++\" >&2\n"
      "until [ -e go ]; do sleep 0.01; done\n"
      "echo \"{\\\"verified\\\": true, \\\"arguments\\\": \\\"$*\\\"}\"\n");
  must("algorithm.check", {{"folder", "test_wave"}});
  const json running = viewers_.document_when(
      "algorithm_check", [](const json& document) { return document.is_object() && document["done"] == 3; });
  EXPECT_EQ(running["state"], "running");
  EXPECT_EQ(running["of"], 17);
  EXPECT_EQ(running["step"], "building with g++");
  EXPECT_TRUE(running["proof"].is_null());
  EXPECT_EQ(ask("algorithm.check", {{"folder", "test_wave"}}).text, "test_wave is being verified; wait, or cancel it");
  write_file(project() / "test_wave/go", "");
  const json check =
      viewers_.document_when("algorithm_check", [](const json& document) { return document["state"] != "running"; });
  EXPECT_EQ(check["state"], "passed") << check;
  EXPECT_EQ(check["version"], must("algorithm.read", {{"folder", "test_wave"}})["version"]);
  EXPECT_EQ(check["proof"]["arguments"], "--json " + (project() / "test_wave").string());
}

TEST_F(AlgorithmSessionTest, AProofThatFailsKeepsItsTableAndAnErrorIsOneLine) {
  must("algorithm.create", form("test_wave", 126));
  write_verifier("echo '{\"verified\": false}'; exit 1\n");
  json check = finished_check();
  EXPECT_EQ(check["state"], "failed");
  EXPECT_EQ(check["proof"]["verified"], false);
  write_verifier("echo 'proleg verify: 1 of 17: building' >&2; echo 'proleg verify: a.cpp:3: error: b' >&2; exit 2\n");
  check = finished_check();
  EXPECT_EQ(check["state"], "failed");
  EXPECT_TRUE(check["proof"].is_null());
  EXPECT_EQ(check["error"], "a.cpp:3: error: b");
}

TEST_F(AlgorithmSessionTest, AProofThatIsCancelledLeavesNoProcess) {
  must("algorithm.create", form("test_wave", 126));
  write_verifier("sleep 1000 & echo \"proleg verify: 1 of 2: $!\" >&2\nwait\n");
  must("algorithm.check", {{"folder", "test_wave"}});
  const json running = viewers_.document_when(
      "algorithm_check", [](const json& document) { return document.is_object() && document["done"] == 1; });
  const int process = std::stoi(running["step"].get<std::string>());
  must("algorithm.cancel");
  const json check =
      viewers_.document_when("algorithm_check", [](const json& document) { return document["state"] != "running"; });
  EXPECT_EQ(check["state"], "cancelled");
  // It is gone, or waits for the process that has taken it over; a busy computer ends it a moment after the signal.
  std::string stat;
  const auto has_ended = [&] {
    stat = file_contents("/proc/" + std::to_string(process) + "/stat");
    return stat.empty() || stat.find(") Z ") != std::string::npos || stat.find("(sleep)") == std::string::npos;
  };
  for (int i = 0; i < 12'000 && !has_ended(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(has_ended()) << stat;
}

TEST_F(AlgorithmSessionTest, AnImageIsBuiltFromTheChosenAlgorithms) {
  must("algorithm.create", form("first_wave", 100));
  must("algorithm.create", form("second_wave", 101));
  const fs::path build = fs::canonical(project()) / "build/image";
  // The image is one that was built before: only the way to it is tested here.
  write_builders("echo \"$PWD $*\" >> " + (folder_ / "calls").string() +
                 "\n[ $1 = --build ] || exit 0\nmkdir -p $2/bin $2/user_algorithms\n" +
                 "echo '[3/125] Linking'\n"
                 "echo '#define PROLEG_ALGORITHM_SOURCES 0x1a646ee5U' > $2/user_algorithms/first_wave.algorithm.cpp\n"
                 "printf 'flash\\t82448\\nflash_limit\\t90112\\nstack\\t2048\\nstack_bound\\t1668\\n' > "
                 "$2/bin/proleg_stm32f405.size.tsv\n"
                 "cp " +
                 (folder_ / "image.pimg").string() + " $2/bin/proleg_stm32f405.pimg");
  image::Header header;
  header.board_id = 1;
  header.version = {0, 2, 1};
  header.address = 0x8020200;
  const std::vector<std::uint8_t> body(64, 7);
  image::describe_body(header, body);
  const image::HeaderBytes encoded = encode(header);
  write_file(folder_ / "image.pimg",
             std::string(encoded.begin(), encoded.end()) + std::string(body.begin(), body.end()));

  const json document = finished_image({"second_wave", "first_wave"});
  ASSERT_EQ(document["state"], "passed") << document;
  EXPECT_EQ(document["algorithms"], json({{{"folder", "second_wave"}, {"name", "second_wave"}},
                                          {{"folder", "first_wave"}, {"name", "first_wave"}}}));
  const json& image = document["image"];
  EXPECT_EQ(image["file"], (build / "bin/proleg_stm32f405.pimg").string());
  EXPECT_EQ(image["command"], "proleg flash --bus can0 " + (build / "bin/proleg_stm32f405.pimg").string());
  EXPECT_EQ(image["version"], "0.2.1");
  EXPECT_EQ(image["commit"], json());
  EXPECT_EQ(image["sha256"], sha256_hex(std::string(body.begin(), body.end())));
  EXPECT_EQ(image["flash"], 82448);
  EXPECT_EQ(image["flash_limit"], 90112);
  EXPECT_EQ(image["ram"], json());
  EXPECT_EQ(image["stack"], 1668);
  EXPECT_EQ(image["algorithms"][0], json({{"name", "second_wave"}, {"sources", nullptr}}));
  EXPECT_EQ(image["algorithms"][1], json({{"name", "first_wave"}, {"sources", "0x1A646EE5"}}));
  const std::string tree = source_path("");
  const std::string folder = fs::canonical(project()).string();
  EXPECT_EQ(file_contents(folder_ / "calls"), tree + " --preset stm32f405 -B " + build.string() +
                                                  " -DPROLEG_USER_ALGORITHMS=" + folder + "/second_wave;" + folder +
                                                  "/first_wave\n" + tree + " --build " + build.string() +
                                                  " --target proleg_stm32f405 proleg_boot_stm32f405\n");

  // What a failed build leaves may not be flashed.
  write_builders("[ $1 = --build ] || exit 0; echo 'ld: region `slot_a` overflowed by 120 bytes'; exit 1");
  const json failed = finished_image({"first_wave"});
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_EQ(failed["error"],
            "the algorithms are 120 bytes too large for a module; leave one out, or make them smaller");
  EXPECT_EQ(failed["image"], json());
  EXPECT_FALSE(fs::exists(build / "bin/proleg_stm32f405.pimg"));
}

TEST_F(AlgorithmSessionTest, AnImageThatCannotBeBuiltSaysWhyInALine) {
  must("algorithm.create", form("first_wave", 100));
  EXPECT_EQ(ask("algorithm.image").text, "folders: found none, expected at least one algorithm");
  EXPECT_EQ(ask("algorithm.image", {{"folders", {"first_wave", "first_wave"}}}).text,
            "folders: found two algorithms 'first_wave', expected different names");
  EXPECT_TRUE(ask("algorithm.image", {{"folders", {".."}}}).text.starts_with("folder: found '..'"));
  EXPECT_TRUE(ask("algorithm.image", {{"folders", 3}}).text.starts_with("folders: found 3"));
  const std::vector<std::pair<std::string, std::string>> cases{
      {"ld: the image is larger than max_image_size", "the algorithms are too large for the flash of a module"},
      {"a.elf: found a stack of 2048 bytes, expected the 3592 that it can need at worst",
       "the algorithms need too much stack: 3592 bytes at worst, a module has 2048"},
      {"fatal error: error writing to /tmp/x.s: No space left on device", "the disk of "},
      {"ld: cannot open output file bin/a.elf: Read-only file system", "a file in "},
      {"something else", "something else"}};
  for (const auto& [output, begin] : cases) {
    write_builders("[ $1 = --build ] || exit 0; echo '" + output + "'; exit 1");
    const json document = finished_image({"first_wave"});
    EXPECT_EQ(document["state"], "failed");
    EXPECT_TRUE(document["error"].get<std::string>().starts_with(begin)) << document["error"];
  }
  fs::remove_all(project() / "build");
  write_file(project() / "build", "a file in the way");
  EXPECT_NE(ask("algorithm.image", {{"folders", {"first_wave"}}}).text.find("cannot be made"), std::string::npos);
  setenv("PATH", (folder_ / "nothing").c_str(), 1);
  EXPECT_TRUE(
      ask("algorithm.image", {{"folders", {"first_wave"}}})
          .text.starts_with(
              "found no arm-none-eabi-g++, expected it in a folder of PATH: sudo apt install gcc-arm-none-eabi"));
}

TEST_F(AlgorithmSessionTest, AnImageThatIsCancelledIsNone) {
  must("algorithm.create", form("first_wave", 100));
  write_builders("echo '[1/125] Building'; sleep 1000");
  must("algorithm.image", {{"folders", {"first_wave"}}});
  viewers_.document_when("algorithm_image", [](const json& document) { return document["of"] == 125; });
  EXPECT_EQ(ask("algorithm.build", {{"folder", "first_wave"}}).text, "the image is being built; wait, or cancel it");
  must("algorithm.cancel");
  const json document =
      viewers_.document_when("algorithm_image", [](const json& each) { return each["state"] != "running"; });
  EXPECT_EQ(document["state"], "cancelled");
  EXPECT_EQ(document["image"], json());
}

// One test, because the core is compiled for it.
TEST_F(AlgorithmSessionTest, ABuildNamesTheLineOfAnErrorAndLoadsWhatPasses) {
  json filled = form("test_wave", 126);
  filled["touch"] = true;
  filled["values"] = {{{"name", "waited"}, {"unit", "count"}, {"help", "ticks since the last touch"}}};
  filled["parameters"].push_back({{"name", "delay"},
                                  {"unit", "count"},
                                  {"minimum", "0"},
                                  {"default", "3"},
                                  {"maximum", "250"},
                                  {"help", "ticks to wait after a touch"}});
  must("algorithm.create", filled);
  replace("return about; }", "return abut; }");
  json build = finished_build();
  EXPECT_EQ(build["state"], "failed");
  ASSERT_GE(build["messages"].size(), 1U) << build;
  EXPECT_EQ(build["messages"][0]["file"], "test_wave.cpp");
  EXPECT_EQ(build["messages"][0]["severity"], "error");
  EXPECT_NE(build["messages"][0]["text"].get<std::string>().find("abut"), std::string::npos);
  EXPECT_EQ(find_algorithm("test_wave"), nullptr);
  EXPECT_EQ(loads_, 0);

  replace("return abut; }", "return about; }");
  build = finished_build();
  ASSERT_EQ(build["state"], "passed") << build;
  EXPECT_EQ(build["version"], must("algorithm.read", {{"folder", "test_wave"}})["version"]);
  EXPECT_EQ(loads_, 1);
  const ActuationModule* const first = find_algorithm("test_wave");
  ASSERT_NE(first, nullptr);
  EXPECT_TRUE(first->senses_contacts());
  EXPECT_EQ(first->declaration().parameters.back().maximum, 250);
  EXPECT_EQ(first->declaration().internal_values.size(), 4U);
  const std::size_t count = algorithm_count();
  EXPECT_EQ(viewers_.document("algorithms").back()["name"], "test_wave");
  EXPECT_EQ(viewers_.document("algorithm_folders")["folders"][0]["loaded"], true);

  replace("a sine with a second harmonic", "another sine");
  ASSERT_EQ(finished_build()["state"], "passed");
  EXPECT_EQ(loads_, 2);
  const ActuationModule* const second = find_algorithm("test_wave");
  EXPECT_NE(second, first);
  EXPECT_EQ(std::string_view(second->declaration().help), "another sine");
  EXPECT_EQ(std::string_view(first->declaration().help), "a sine with a second harmonic") << "who has it goes on";
  EXPECT_EQ(algorithm_count(), count);

  replace("    126, \"test_wave\"", "    126, \"PatternGenerator_sinusoidal\"");
  build = finished_build();
  EXPECT_EQ(build["state"], "failed");
  EXPECT_NE(build["error"].get<std::string>().find("expected another name and id"), std::string::npos) << build;
  EXPECT_EQ(find_algorithm("test_wave"), second) << "what was loaded before stays";
}

TEST_F(AlgorithmSessionTest, OnlyOneBuildAtATimeAndItCanBeCancelled) {
  json filled = form("other_wave", 125);
  filled["parameters"].erase(0);  // it is no wave then
  must("algorithm.create", filled);
  EXPECT_EQ(ask("algorithm.cancel").text, "nothing is being built or verified");
  must("algorithm.build", {{"folder", "other_wave"}});
  EXPECT_EQ(ask("algorithm.build", {{"folder", "other_wave"}}).text, "other_wave is being built; wait, or cancel it");
  must("algorithm.cancel");
  const json build = viewers_.document_when(
      "algorithm_build", [](const json& document) { return document.is_object() && document["state"] != "running"; });
  EXPECT_EQ(build["state"], "cancelled");
  must("algorithm.build", {{"folder", "other_wave"}});
  const json again = viewers_.document_when("algorithm_build", [](const json& document) {
    return document["state"] == "passed" || document["state"] == "failed";
  });
  EXPECT_EQ(again["state"], "passed") << again;
}

}  // namespace
}  // namespace proleg::tools
